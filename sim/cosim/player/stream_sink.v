// Takes a valid/ready stream with random stalls and writes each payload to "<folder>/<frame>.<NAME>", hexadecimal.
//
// `ready` is high with probability (rate + 1) / 256 a cycle, whatever `valid` does.
module stream_sink #(
    parameter WIDTH = 64,
    parameter NAME = "words",
    parameter [31:0] SALT = 1
) (
    input clk,
    input rst,
    input start,
    input [31:0] frame,
    input [31:0] seed,
    input [7:0] rate,
    input valid,
    input [WIDTH-1:0] payload,
    output reg ready
);
    reg [8*512-1:0] folder;
    reg [8*600-1:0] path;
    integer file;
    reg [31:0] random;

    initial begin
        file = 0;
        ready = 0;
        random = 1;
        if (!$value$plusargs("folder=%s", folder)) folder = ".";
    end

    always @(posedge clk) begin
        random <= {random[30:0], random[31] ^ random[21] ^ random[1] ^ random[0]};
        ready <= random[12:5] <= rate;
        if (rst) begin
            ready <= 0;
        end else if (start) begin
            if (file != 0) $fclose(file);
            $sformat(path, "%0s/%0d.%0s", folder, frame, NAME);
            file = $fopen(path, "w");
            random <= (seed * 32'd2654435761 + SALT) | 32'd1;
        end else if (valid && ready && file != 0) begin
            $fdisplay(file, "%h", payload);
        end
    end
endmodule
