// Plays words through a component with one stream in and one out: files in, files out, at the simulator's own speed.
//
// It has the ports of `frame_player`, so that `sim/cosim/player/frame_bench.py` drives it: the rates of code words and raster are
// those of the streams, and `finished` says that the word END came out.
`timescale 1ns / 1ps
module word_player #(
    parameter [63:0] END = 0
) (
    input clk,
    input rst,
    input start,
    input [31:0] frame,
    input [31:0] seed,
    input [31:0] tables_first,
    input [31:0] table_frames,
    input initial_waits,
    input [31:0] frames,
    input [7:0] codeword_rate,
    input [7:0] table_rate,
    input [7:0] initial_rate,
    input [7:0] raster_rate,
    output reg finished,
    output reg [31:0] cycles,
    output reg [31:0] taken,
    output reg [31:0] stray,
    output [31:0] breaches
);
    wire [63:0] in, out;
    wire in_valid, in_ready, out_valid, out_ready;

    stream_source #(.WIDTH(64), .NAME("codewords"), .SALT(22)) source (
        .clk(clk), .rst(rst), .start(start), .frame(frame), .seed(seed), .rate(codeword_rate), .run(1'b1),
        .valid(in_valid), .payload(in), .ready(in_ready));
    stream_sink #(.WIDTH(64), .NAME("words"), .SALT(44)) sink (
        .clk(clk), .rst(rst), .start(start), .frame(frame), .seed(seed), .rate(raster_rate),
        .valid(out_valid), .payload(out), .ready(out_ready));
    stream_check #(.WIDTH(64)) check (
        .clk(clk), .rst(rst), .valid(out_valid), .payload(out), .ready(out_ready), .breaches(breaches));

    dut dut (
        .clk(clk), .rst(rst), .i__payload(in), .i__valid(in_valid), .i__ready(in_ready),
        .o__payload(out), .o__valid(out_valid), .o__ready(out_ready));

    initial begin
        finished = 0;
        cycles = 0;
        taken = 0;
        stray = 0;
    end

    always @(posedge clk) begin
        if (rst || start) begin
            finished <= 0;
            cycles <= 0;
            taken <= 0;
            stray <= 0;
        end else begin
            if (in_valid && in_ready) taken <= taken + 1;
            if (!finished && (taken != 0 || (in_valid && in_ready))) cycles <= cycles + 1;
            if (out_valid && out_ready && out == END) finished <= 1;
            if (out_valid && (finished || taken == 0)) stray <= stray + 1;
        end
    end
endmodule
