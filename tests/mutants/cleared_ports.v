// The ports of a memory that is cleared after reset. Until that is done, what goes in does not count, and what comes
// out may differ between the two designs. Later the rest of a word may differ where its lowest DEPTH bits are all 1:
// the colour of background. `GATE` says which of the two designs it is in.
module cleared_ports #(parameter READS = 1, WRITES = 1, ABITS = 1, WIDTH = 1, DEPTH = 0, GATE = 0) (
    input sweeping, swept,
    input [READS*ABITS-1:0] read_address, output [READS*WIDTH-1:0] read_data,
    input [WRITES*WIDTH-1:0] write_enable, input [WRITES*ABITS-1:0] write_address,
    input [WRITES*WIDTH-1:0] write_data);
    wire clearing = sweeping | swept;
    wire [READS*WIDTH-1:0] same, gold, gate;
    wire [READS*WIDTH-1:0] own = GATE ? gate : gold;
    cleared_memory #(.READS(READS), .WRITES(WRITES), .ABITS(ABITS), .WIDTH(WIDTH)) memory (
        .sweeping(sweeping), .swept(swept), .read_address(clearing ? 0 : read_address), .same(same), .gold(gold), .gate(gate),
        .write_enable(clearing ? 0 : write_enable), .write_address(clearing ? 0 : write_address),
        .write_data(clearing ? 0 : write_data));
    genvar n;
    generate
        for (n = 0; n < READS*WIDTH; n = n + 1) begin : bits
            if (DEPTH > 0 && n % WIDTH >= DEPTH)
                assign read_data[n] = (clearing | &same[n / WIDTH * WIDTH +: DEPTH]) ? own[n] : same[n];
            else
                assign read_data[n] = clearing ? own[n] : same[n];
        end
    endgenerate
endmodule
// What is compared of such a memory, which becomes ports of its module.
(* keep_hierarchy *)
module cleared_memory #(parameter READS = 1, WRITES = 1, ABITS = 1, WIDTH = 1) (
    input sweeping, swept,
    input [READS*ABITS-1:0] read_address, output [READS*WIDTH-1:0] same, gold, gate,
    input [WRITES*WIDTH-1:0] write_enable, input [WRITES*ABITS-1:0] write_address,
    input [WRITES*WIDTH-1:0] write_data);
    assign same = 0, gold = 0, gate = 0;
endmodule
