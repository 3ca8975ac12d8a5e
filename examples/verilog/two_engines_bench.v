// Plays the first frame of `splatline verilog --bench` to two_engines.v and compares both rasters with golden's.
//
// Prints PASS, or FAIL with the engine and the beat, and ends with exit code 1.
`include "paper/bench_sizes.vh"  // lengths of the files, the same for both

module two_engines_bench;
    reg clk = 0;
    reg rst = 1;
    always #5 clk = ~clk;

    reg [63:0] codewords [0:`CODEWORDS-1];
    reg [43:0] paper_tables [0:2*`TABLES_OF_FRAME-1];
    reg [67:0] rgb24_tables [0:2*`TABLES_OF_FRAME-1];
    reg [89:0] paper_beats [0:`BEATS-1];
    reg [149:0] rgb24_beats [0:`BEATS-1];
    initial begin
        $readmemh("paper/codewords.hex", codewords);
        $readmemh("paper/tables.hex", paper_tables);
        $readmemh("rgb24/tables.hex", rgb24_tables);
        $readmemh("paper/raster.hex", paper_beats);
        $readmemh("rgb24/raster.hex", rgb24_beats);
    end

    // Tables first, then code words: those of the first of two frames.
    localparam TABLES = `TABLES_OF_FRAME;
    reg [31:0] paper_written = 0, rgb24_written = 0, sent = 0;
    wire written = paper_written == TABLES && rgb24_written == TABLES;
    wire [63:0] word = codewords[sent];
    wire [89:0] paper_beat;
    wire [149:0] rgb24_beat;
    wire word_ready, paper_table_ready, rgb24_table_ready, paper_valid, rgb24_valid;
    wire ended = sent == `CODEWORDS_OF_FIRST;

    two_engines engines (
        .clk(clk), .rst(rst),
        .codewords(word), .codewords_valid(written && !ended), .codewords_ready(word_ready),
        .paper_tables(paper_tables[paper_written]), .paper_tables_valid(paper_written < TABLES),
        .paper_tables_ready(paper_table_ready),
        .rgb24_tables(rgb24_tables[rgb24_written]), .rgb24_tables_valid(rgb24_written < TABLES),
        .rgb24_tables_ready(rgb24_table_ready),
        .paper_raster(paper_beat), .paper_raster_valid(paper_valid), .paper_raster_ready(1'b1),
        .rgb24_raster(rgb24_beat), .rgb24_raster_valid(rgb24_valid), .rgb24_raster_ready(1'b1));

    reg [31:0] paper_taken = 0, rgb24_taken = 0, cycles = 0;
    reg paper_ended = 0, rgb24_ended = 0;

    always @(posedge clk) begin
        rst <= 0;
        cycles <= cycles + 1;
        if (!rst) begin
            if (paper_written < TABLES && paper_table_ready) paper_written <= paper_written + 1;
            if (rgb24_written < TABLES && rgb24_table_ready) rgb24_written <= rgb24_written + 1;
            if (written && !ended && word_ready) sent <= sent + 1;
            if (paper_valid) begin
                paper_taken <= paper_taken + 1;
                paper_ended <= paper_beat[89];
                // Of an end beat no other bit counts.
                if (paper_beat[89] ? paper_beats[paper_taken][89] !== 1 : paper_beat !== paper_beats[paper_taken])
                    fail("paper", paper_taken);
            end
            if (rgb24_valid) begin
                rgb24_taken <= rgb24_taken + 1;
                rgb24_ended <= rgb24_beat[149];
                if (rgb24_beat[149] ? rgb24_beats[rgb24_taken][149] !== 1 : rgb24_beat !== rgb24_beats[rgb24_taken])
                    fail("rgb24", rgb24_taken);
            end
            if (paper_ended && rgb24_ended) begin
                $display("PASS: %0d beats of paper, %0d of rgb24", paper_taken, rgb24_taken);
                $finish;
            end
            if (cycles == 20000) fail("stuck", sent);
        end
    end

    task fail(input [8*8-1:0] what, input [31:0] number);
        begin
            $display("FAIL: %0s, beat %0d", what, number);
            $fatal;
        end
    endtask
endmodule
