// Offers the numbers of a file on a valid/ready stream, with random gaps.
//
// `start` opens "<folder>/<frame>.<NAME>", which has one hexadecimal number a line. A missing file counts as empty.
// While `run` is high, a gap before a payload ends with probability (rate + 1) / 256 in each cycle. An offered payload
// stays until it is taken. Between payloads it is undefined, or random in a simulator without undefined values.
module stream_source #(
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
    input run,
    output reg valid,
    output [WIDTH-1:0] payload,
    input ready
);
    reg [8*512-1:0] folder;
    reg [8*600-1:0] path;
    integer file;
    integer got;
    reg [WIDTH-1:0] next;
    reg more;
    reg [31:0] random;
    reg [WIDTH-1:0] offered;
`ifdef VERILATOR
    assign payload = valid ? offered : {(WIDTH + 31) / 32{random}};
`else
    assign payload = valid ? offered : {WIDTH{1'bx}};
`endif

    initial begin
        file = 0;
        more = 0;
        valid = 0;
        offered = 0;
        random = 1;
        if (!$value$plusargs("folder=%s", folder)) folder = ".";
    end

    always @(posedge clk) begin
        random <= {random[30:0], random[31] ^ random[21] ^ random[1] ^ random[0]};
        if (rst) begin
            valid <= 0;
            more <= 0;
        end else if (start) begin
            if (file != 0) $fclose(file);
            $sformat(path, "%0s/%0d.%0s", folder, frame, NAME);
            file = $fopen(path, "r");
            got = 0;
            if (file != 0) got = $fscanf(file, "%h", next);
            more <= got == 1;
            valid <= 0;
            random <= (seed * 32'd2654435761 + SALT) | 32'd1;
        end else if (!valid || ready) begin
            valid <= 0;
            if (more && run && random[12:5] <= rate) begin
                valid <= 1;
                offered <= next;
                got = $fscanf(file, "%h", next);
                more <= got == 1;
            end
        end
    end
endmodule
