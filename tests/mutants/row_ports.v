// The ports of a memory of a row of lanes. `age` counts the cycles after a reset, and the row clears the memory's words
// one after the other, the first when `age` is 3, the last when it is SWEEP + 2. Until then what goes in does not
// count, and what comes out may differ between the two designs; `cleared` is 1 while the row writes as it must.
module row_ports #(parameter READS = 1, WRITES = 1, ABITS = 1, WIDTH = 1, DEPTH = 1, SWEEP = 1, AGE = 1, GATE = 0) (
    input [AGE-1:0] age,
    input [READS*ABITS-1:0] read_address, output [READS*WIDTH-1:0] read_data,
    input [WRITES*WIDTH-1:0] write_enable, input [WRITES*ABITS-1:0] write_address,
    input [WRITES*WIDTH-1:0] write_data);
    wire clearing = age < SWEEP + 3;
    wire [ABITS-1:0] place = age - 3;
    wire [WIDTH-1:0] background = {DEPTH{1'b1}};
    wire [READS*WIDTH-1:0] same, gold, gate;
    wire [WRITES-1:0] writes, clears;
    genvar n;
    generate
        for (n = 0; n < WRITES; n = n + 1) begin
            assign writes[n] = |write_enable[n*WIDTH +: WIDTH];
            assign clears[n] = &write_enable[n*WIDTH +: WIDTH] & write_address[n*ABITS +: ABITS] == place
                & write_data[n*WIDTH +: WIDTH] == background;
        end
    endgenerate
    row_memory #(.READS(READS), .WRITES(WRITES), .ABITS(ABITS), .WIDTH(WIDTH)) memory (
        .read_address(clearing ? 0 : read_address), .same(same), .gold(gold), .gate(gate),
        .write_enable(clearing ? 0 : write_enable), .write_address(clearing ? 0 : write_address),
        .write_data(clearing ? 0 : write_data), .cleared(!clearing | age < 3 | |clears & writes == clears));
    assign read_data = !clearing ? same : GATE ? gate : gold;
endmodule
// What is compared of such a memory, which becomes ports of its module.
(* keep_hierarchy *)
module row_memory #(parameter READS = 1, WRITES = 1, ABITS = 1, WIDTH = 1) (
    input [READS*ABITS-1:0] read_address, output [READS*WIDTH-1:0] same, gold, gate,
    input [WRITES*WIDTH-1:0] write_enable, input [WRITES*ABITS-1:0] write_address,
    input [WRITES*WIDTH-1:0] write_data, input cleared);
    assign same = 0, gold = 0, gate = 0;
endmodule
