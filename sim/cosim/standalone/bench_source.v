// Offers the numbers of a file on a stream, each until it is taken, while fewer than `due` were taken.
module bench_source #(
    parameter WIDTH = 64,
    parameter LENGTH = 1,
    parameter FILE = "words.hex",
    parameter [31:0] SEED = 1
) (
    input clk,
    input rst,
    input gaps,
    input [31:0] due,
    output [31:0] taken,
    output reg valid,
    output reg [WIDTH-1:0] payload,
    input ready
);
    reg [WIDTH-1:0] words [0:LENGTH-1];
    initial $readmemh(FILE, words);

    reg [31:0] random = SEED;
    reg [31:0] offered = 0;
    initial valid = 0;
    assign taken = offered - valid;

    always @(posedge clk) begin
        random <= {random[30:0], random[31] ^ random[21] ^ random[1] ^ random[0]};
        if (rst) begin
            valid <= 0;
            offered <= 0;
        end else if (!valid || ready) begin
            valid <= 0;
            payload <= {WIDTH{1'bx}};
            if (offered < due && (!gaps || random[8])) begin
                valid <= 1;
                payload <= words[offered];
                offered <= offered + 1;
            end
        end
    end
endmodule
