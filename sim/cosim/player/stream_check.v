// Counts breaches of the stream rule: an offered payload stays valid and unchanged until it is taken.
module stream_check #(
    parameter WIDTH = 64
) (
    input clk,
    input rst,
    input valid,
    input [WIDTH-1:0] payload,
    input ready,
    output reg [31:0] breaches
);
    reg waiting;
    reg [WIDTH-1:0] offered;

    initial begin
        breaches = 0;
        waiting = 0;
    end

    always @(posedge clk) begin
        if (waiting && !rst && (!valid || payload != offered)) breaches <= breaches + 1;
        waiting <= valid && !ready && !rst;
        offered <= payload;
    end
endmodule
