// Plays frames to an engine and compares every beat of its raster with what the golden renderer says.
//
// Prints PASS and ends with exit code 0, or prints FAIL with the first unlike beat and ends with exit code 1.
// bench_sizes.vh, beside it, has the engine's name, the widths of its streams and the lengths of the files.
//
// The first frame starts from background, the second from the raster in initial.hex. Both are drawn twice, with a reset
// between: as fast as the engine takes them, then with random gaps on every stream. While a stream's valid is 0, its
// payload is undefined.
//
// Verilog-2005, and $fatal of SystemVerilog for the exit code.
`include "bench_sizes.vh"

module bench;
    localparam PATIENCE = 20000;  // cycles without a transfer after which the engine counts as stuck
    localparam QUIET = 64;        // cycles after the last end beat in which no further beat may come

    reg clk = 0;
    reg rst = 1;
    reg gaps = 0;  // of the second pass
    always #5 clk = ~clk;

    wire table_valid, codeword_valid, initial_valid;
    wire table_ready, codeword_ready, initial_ready, beat_valid;
    wire [`TABLE_BITS-1:0] table_write;
    wire [`CODEWORD_BITS-1:0] codeword;
    wire [`BEAT_BITS-1:0] initial_beat, beat;
    reg beat_ready = 0;

    // Tables of a frame, then its code words, then those of the next.
    wire [31:0] tables, codewords, initials;  // transfers so far
    wire drawing = codewords >= `CODEWORDS_OF_FIRST;  // the second frame
    wire [31:0] tables_due = drawing ? 2 * `TABLES_OF_FRAME : `TABLES_OF_FRAME;
    wire [31:0] codewords_due = tables < tables_due ? codewords : drawing ? `CODEWORDS : `CODEWORDS_OF_FIRST;

    bench_source #(.WIDTH(`TABLE_BITS), .LENGTH(2 * `TABLES_OF_FRAME), .FILE("tables.hex"), .SEED(11)) table_source (
        .clk(clk), .rst(rst), .gaps(gaps), .due(tables_due), .taken(tables),
        .valid(table_valid), .payload(table_write), .ready(table_ready));
    bench_source #(.WIDTH(`CODEWORD_BITS), .LENGTH(`CODEWORDS), .FILE("codewords.hex"), .SEED(22)) codeword_source (
        .clk(clk), .rst(rst), .gaps(gaps), .due(codewords_due), .taken(codewords),
        .valid(codeword_valid), .payload(codeword), .ready(codeword_ready));
    bench_source #(.WIDTH(`BEAT_BITS), .LENGTH(`INITIALS), .FILE("initial.hex"), .SEED(33)) initial_source (
        .clk(clk), .rst(rst), .gaps(gaps), .due(drawing ? `INITIALS : 0), .taken(initials),
        .valid(initial_valid), .payload(initial_beat), .ready(initial_ready));

    `ENGINE engine (
        .clk(clk), .rst(rst),
        .tables__payload(table_write), .tables__valid(table_valid), .tables__ready(table_ready),
        .codewords__payload(codeword), .codewords__valid(codeword_valid), .codewords__ready(codeword_ready),
        .initial__payload(initial_beat), .initial__valid(initial_valid), .initial__ready(initial_ready),
        .raster__payload(beat), .raster__valid(beat_valid), .raster__ready(beat_ready),
        .in_frame());

    reg [`BEAT_BITS-1:0] expected [0:`BEATS-1];
    initial $readmemh("raster.hex", expected);

    reg [31:0] random = 32'd44;
    reg [31:0] beats = 0;      // taken so far
    reg [31:0] idle = 0;       // cycles since the last transfer
    reg waiting = 0;           // a beat was offered and not taken
    reg [`BEAT_BITS-1:0] offered;
    wire ends = expected[beats][`BEAT_BITS-1];  // of an end beat no other bit counts
    wire unlike = ends ? beat[`BEAT_BITS-1] !== 1 : beat !== expected[beats];
    wire transfer = beat_valid && beat_ready || table_valid && table_ready || codeword_valid && codeword_ready
        || initial_valid && initial_ready;

    // Each pass begins with one clock edge in reset.
    always @(posedge clk) begin
        random <= {random[30:0], random[31] ^ random[21] ^ random[1] ^ random[0]};
        beat_ready <= !rst && (!gaps || random[8]);
        idle <= rst || transfer ? 0 : idle + 1;
        waiting <= beat_valid && !beat_ready && !rst;
        offered <= beat;
        if (rst) begin
            rst <= 0;
            beats <= 0;
        end else if (beat_valid !== 0 && beat_valid !== 1) fail("raster__valid is undefined");
        else if (waiting && (!beat_valid || beat !== offered)) fail("a beat changed before it was taken");
        else if (beat_valid && beats == `BEATS) fail("a beat after the last frame's end");
        else if (beat_valid && beat_ready) begin
            if (unlike) begin
                $display("beat     %h", beat);
                $display("expected %h", expected[beats]);
                fail("an unlike beat");
            end
            beats <= beats + 1;
        end else if (beats < `BEATS && idle == PATIENCE) fail("the engine is stuck");
        else if (beats == `BEATS && idle == QUIET) begin
            if (tables != 2 * `TABLES_OF_FRAME || codewords != `CODEWORDS || initials != `INITIALS)
                fail("the engine left input untaken");
            else if (gaps) begin
                $display("PASS: %0d beats, twice: without gaps and with gaps", beats);
                $finish;
            end
            gaps <= 1;
            rst <= 1;
        end
    end

    task fail(input [8*40-1:0] what);
        begin
            $display("FAIL: %0s, beat %0d, pass %0d, %0t", what, beats, gaps, $time);
            $fatal;
        end
    endtask
endmodule
