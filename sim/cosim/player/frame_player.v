// Plays whole frames to an engine or a chain, from files to files, at the simulator's own speed. Each engine has a file
// of code words, "<folder>/<frame>.codewords_00" and so on.
//
// cocotb sets the rates and the seed, pulses `start`, optionally resets, and waits for `finished`.
//
// There are `frames` frames. Each of the first `table_frames` has `tables_first` table writes. Those of the first frame
// come before its first code word. Those of a later frame are offered once the frame before is open; the code words of
// the later frame follow once the first of them is offered. With `initial_waits`, the initial raster of a frame is
// offered only once the picture before has left. All other streams are offered as fast as they are taken.
//
// `cycles` counts from the first code word taken to the last end beat, both included. "<folder>/<frame>.events" records
// events, one a line: name, number of the engine, and cycle since `start`.
//
// Module `player_ports`, which player.py writes, has the streams of code words as vectors, engine 0 lowest.
`timescale 1ns / 1ps
module frame_player #(
    parameter ENGINES = 1,
    parameter WORD_BITS = 64,
    parameter TABLE_BITS = 44,
    parameter RASTER_BITS = 90
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
    reg [31:0] tables_taken;
    wire [WORD_BITS*ENGINES-1:0] codewords;
    wire [ENGINES-1:0] codeword_valid, codeword_ready;
    wire [TABLE_BITS-1:0] table_write;
    wire table_valid, table_ready;
    wire [RASTER_BITS-1:0] initial_beat;
    wire initial_valid, initial_ready;
    wire [RASTER_BITS-1:0] beat;
    wire beat_valid, beat_ready;
    wire [ENGINES-1:0] takes = codeword_valid & codeword_ready;
    reg [31:0] clock;
    reg [31:0] ended;
    reg [31:0] initials_ended;

    // Table writes of a frame wait until the frame before has begun: engines between frames take them at once.
    reg [31:0] begun;
    stream_source #(.WIDTH(TABLE_BITS), .NAME("tables"), .SALT(11)) tables (
        .clk(clk), .rst(rst), .start(start), .frame(frame), .seed(seed), .rate(table_rate),
        .run(tables_taken + table_valid < tables_first * (begun + 1)),
        .valid(table_valid), .payload(table_write), .ready(table_ready));
    stream_source #(.WIDTH(RASTER_BITS), .NAME("initial"), .SALT(33)) initials (
        .clk(clk), .rst(rst), .start(start), .frame(frame), .seed(seed), .rate(initial_rate),
        .run(!initial_waits || initials_ended + (initial_valid && initial_beat[RASTER_BITS-1]) <= ended),
        .valid(initial_valid), .payload(initial_beat), .ready(initial_ready));
    stream_sink #(.WIDTH(RASTER_BITS), .NAME("raster"), .SALT(44)) rasters (
        .clk(clk), .rst(rst), .start(start), .frame(frame), .seed(seed), .rate(raster_rate),
        .valid(beat_valid), .payload(beat), .ready(beat_ready));
    stream_check #(.WIDTH(RASTER_BITS)) check (
        .clk(clk), .rst(rst), .valid(beat_valid), .payload(beat), .ready(beat_ready), .breaches(breaches));

    player_ports engines (
        .clk(clk), .rst(rst),
        .codewords(codewords), .codewords_valid(codeword_valid), .codewords_ready(codeword_ready),
        .tables(table_write), .tables_valid(table_valid), .tables_ready(table_ready),
        .initial_beat(initial_beat), .initial_valid(initial_valid), .initial_ready(initial_ready),
        .raster(beat), .raster_valid(beat_valid), .raster_ready(beat_ready));

    reg [8*512-1:0] folder;
    reg [8*600-1:0] path;
    integer events;
    initial begin
        events = 0;
        if (!$value$plusargs("folder=%s", folder)) folder = ".";
    end

    always @(posedge clk) begin
        if (start) begin
            if (events != 0) $fclose(events);
            $sformat(path, "%0s/%0d.events", folder, frame);
            events = $fopen(path, "w");
        end
    end

    // `opened`: frames that each engine has begun. `begun`: their maximum over the engines.
    reg [32*ENGINES-1:0] opened;
    wire [ENGINES-1:0] opens;
    integer e;
    initial begun = 0;
    always @(posedge clk) begin
        if (rst || start) begin
            begun <= 0;
            opened <= 0;
        end else begin
            for (e = 0; e < ENGINES; e = e + 1)
                if (opens[e]) begin
                    opened[32*e +: 32] <= opened[32*e +: 32] + 1;
                    if (opened[32*e +: 32] == begun) begun <= begun + 1;
                end
        end
    end

    genvar n;
    generate
        for (n = 0; n < ENGINES; n = n + 1) begin : engine
            wire [WORD_BITS-1:0] word = codewords[WORD_BITS*n +: WORD_BITS];
            // An end word: mode 1, four empty rows, and the bit for the end of the frame.
            wire ends = word[0] && word[25] && word[3:1] > word[6:4] && word[9:7] > word[12:10]
                && word[15:13] > word[18:16] && word[21:19] > word[24:22];
            reg open;
            // Code words of a frame wait for the first of its table writes; otherwise the engine would begin the frame
            // without them.
            reg [31:0] ended;
            wire [31:0] following = ended + (codeword_valid[n] && ends);
            wire may = following >= table_frames || tables_taken + (table_valid && following != 0) > tables_first * following;
            assign opens[n] = takes[n] && !open;
            localparam [7:0] TENS = 48 + n / 10;
            localparam [7:0] ONES = 48 + n % 10;
            stream_source #(.WIDTH(WORD_BITS), .NAME({"codewords_", TENS, ONES}), .SALT(22 + 101 * n)) source (
                .clk(clk), .rst(rst), .start(start), .frame(frame), .seed(seed), .rate(codeword_rate),
                .run(tables_taken >= tables_first && may),
                .valid(codeword_valid[n]), .payload(codewords[WORD_BITS*n +: WORD_BITS]), .ready(codeword_ready[n]));
            always @(posedge clk) begin
                if (rst || start) begin
                    open <= 0;
                    ended <= 0;
                end else if (takes[n]) begin
                    open <= !ends;
                    ended <= ended + ends;
                    if (opens[n]) $fdisplay(events, "open %0d %0d", n, clock);
                    if (ends) $fdisplay(events, "close %0d %0d", n, clock);
                end
            end
        end
    endgenerate

    reg counting;
    reg first;
    wire last_beat = beat_valid && beat_ready && beat[RASTER_BITS-1];

    initial begin
        finished = 0;
        cycles = 0;
        taken = 0;
        stray = 0;
        counting = 0;
        tables_taken = 0;
        ended = 0;
        initials_ended = 0;
        clock = 0;
        first = 1;
    end

    always @(posedge clk) begin
        clock <= clock + 1;
        if (rst || start) begin
            finished <= 0;
            cycles <= 0;
            taken <= 0;
            stray <= 0;
            counting <= 0;
            tables_taken <= 0;
            ended <= 0;
            initials_ended <= 0;
            clock <= 0;
            first <= 1;
        end else begin
            if (table_valid && table_ready) tables_taken <= tables_taken + 1;
            if (initial_valid && initial_ready) initials_ended <= initials_ended + initial_beat[RASTER_BITS-1];
            if (takes != 0) begin
                taken <= taken + 1;
                if (!finished) counting <= 1;
            end
            if (counting || (takes != 0 && !finished)) cycles <= cycles + 1;
            if (beat_valid && beat_ready && events != 0) begin
                first <= last_beat;
                if (first) $fdisplay(events, "beat 0 %0d", clock);
                if (last_beat) $fdisplay(events, "end 0 %0d", clock);
            end
            if (last_beat) begin
                ended <= ended + 1;
                if (ended + 1 >= frames) begin
                    finished <= 1;
                    counting <= 0;
                end
            end
            // No beat may come after the last end beat, or before the first code word.
            if (beat_valid && (finished || taken == 0)) stray <= stray + 1;
        end
    end
endmodule
