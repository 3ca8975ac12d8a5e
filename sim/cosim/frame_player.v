// Plays whole frames to an engine: files in, files out, at the simulator's own speed.
//
// cocotb sets the rates and the seed, pulses `start`, disturbs, and waits for `finished`. The first `tables_first` table
// writes go before the first code word; all else is offered as fast as it is taken, the tables and code words of
// further frames too, of which there are `frames` in all. `cycles` counts from the first code word taken to the last end
// beat, both included.
`timescale 1ns / 1ps
module frame_player #(
    parameter TABLE_BITS = 44,
    parameter RASTER_BITS = 90
) (
    input clk,
    input rst,
    input start,
    input [31:0] frame,
    input [31:0] seed,
    input [31:0] tables_first,
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
    reg [31:0] tables_taken;
    wire [63:0] codeword;
    wire codeword_valid, codeword_ready;
    wire [TABLE_BITS-1:0] table_write;
    wire table_valid, table_ready;
    wire [RASTER_BITS-1:0] initial_beat;
    wire initial_valid, initial_ready;
    wire [RASTER_BITS-1:0] beat;
    wire beat_valid, beat_ready;

    // Further tables wait for the first frame to open: an engine between frames would take them at once.
    stream_source #(.WIDTH(TABLE_BITS), .NAME("tables"), .SALT(11)) tables (
        .clk(clk), .rst(rst), .start(start), .frame(frame), .seed(seed), .rate(table_rate),
        .run(tables_taken + table_valid < tables_first || taken != 0),
        .valid(table_valid), .payload(table_write), .ready(table_ready));
    stream_source #(.WIDTH(64), .NAME("codewords"), .SALT(22)) codewords (
        .clk(clk), .rst(rst), .start(start), .frame(frame), .seed(seed), .rate(codeword_rate),
        .run(tables_taken >= tables_first),
        .valid(codeword_valid), .payload(codeword), .ready(codeword_ready));
    stream_source #(.WIDTH(RASTER_BITS), .NAME("initial"), .SALT(33)) initials (
        .clk(clk), .rst(rst), .start(start), .frame(frame), .seed(seed), .rate(initial_rate), .run(1'b1),
        .valid(initial_valid), .payload(initial_beat), .ready(initial_ready));
    stream_sink #(.WIDTH(RASTER_BITS), .NAME("raster"), .SALT(44)) rasters (
        .clk(clk), .rst(rst), .start(start), .frame(frame), .seed(seed), .rate(raster_rate),
        .valid(beat_valid), .payload(beat), .ready(beat_ready));
    stream_check #(.WIDTH(RASTER_BITS)) check (
        .clk(clk), .rst(rst), .valid(beat_valid), .payload(beat), .ready(beat_ready), .breaches(breaches));

    splatline engine (
        .clk(clk), .rst(rst),
        .codewords__payload(codeword), .codewords__valid(codeword_valid), .codewords__ready(codeword_ready),
        .tables__payload(table_write), .tables__valid(table_valid), .tables__ready(table_ready),
        .initial__payload(initial_beat), .initial__valid(initial_valid), .initial__ready(initial_ready),
        .raster__payload(beat), .raster__valid(beat_valid), .raster__ready(beat_ready));

    reg counting;
    reg [31:0] ended;
    wire last_beat = beat_valid && beat_ready && beat[RASTER_BITS-1];

    initial begin
        finished = 0;
        cycles = 0;
        taken = 0;
        stray = 0;
        counting = 0;
        tables_taken = 0;
        ended = 0;
    end

    always @(posedge clk) begin
        if (rst || start) begin
            finished <= 0;
            cycles <= 0;
            taken <= 0;
            stray <= 0;
            counting <= 0;
            tables_taken <= 0;
            ended <= 0;
        end else begin
            if (table_valid && table_ready) tables_taken <= tables_taken + 1;
            if (codeword_valid && codeword_ready) begin
                taken <= taken + 1;
                if (!finished) counting <= 1;
            end
            if (counting || (codeword_valid && codeword_ready && !finished)) cycles <= cycles + 1;
            if (last_beat) begin
                ended <= ended + 1;
                if (ended + 1 >= frames) begin
                    finished <= 1;
                    counting <= 0;
                end
            end
            // Nothing may come after the end beat, nor before the first code word.
            if (beat_valid && (finished || taken == 0)) stray <= stray + 1;
        end
    end
endmodule
