// Two engines of Splatline side by side: both draw the same code words, in 9 and in 24 bits of colour.
//
// Each has table writes and a raster of its own. The stream of code words is forked: each engine takes a word once, and
// the word leaves when both have it.
module two_engines (
    input clk,
    input rst,
    input [63:0] codewords,
    input codewords_valid,
    output codewords_ready,
    input [43:0] paper_tables,
    input paper_tables_valid,
    output paper_tables_ready,
    output [89:0] paper_raster,
    output paper_raster_valid,
    input paper_raster_ready,
    input [67:0] rgb24_tables,
    input rgb24_tables_valid,
    output rgb24_tables_ready,
    output [149:0] rgb24_raster,
    output rgb24_raster_valid,
    input rgb24_raster_ready
);
    // An engine that has taken the word while the other has not.
    reg paper_has, rgb24_has;
    wire paper_takes, rgb24_takes;
    wire paper_done = paper_has || paper_takes;
    wire rgb24_done = rgb24_has || rgb24_takes;
    assign codewords_ready = paper_done && rgb24_done;

    always @(posedge clk) begin
        if (rst || !codewords_valid || codewords_ready) begin
            paper_has <= 0;
            rgb24_has <= 0;
        end else begin
            paper_has <= paper_done;
            rgb24_has <= rgb24_done;
        end
    end

    // Both start each frame from background, so nothing is offered on `initial`.
    splatline_paper paper (
        .clk(clk), .rst(rst),
        .codewords__payload(codewords), .codewords__valid(codewords_valid && !paper_has), .codewords__ready(paper_takes),
        .tables__payload(paper_tables), .tables__valid(paper_tables_valid), .tables__ready(paper_tables_ready),
        .initial__payload(90'd0), .initial__valid(1'b0), .initial__ready(),
        .raster__payload(paper_raster), .raster__valid(paper_raster_valid), .raster__ready(paper_raster_ready),
        .in_frame());

    splatline_rgb24 rgb24 (
        .clk(clk), .rst(rst),
        .codewords__payload(codewords), .codewords__valid(codewords_valid && !rgb24_has), .codewords__ready(rgb24_takes),
        .tables__payload(rgb24_tables), .tables__valid(rgb24_tables_valid), .tables__ready(rgb24_tables_ready),
        .initial__payload(150'd0), .initial__valid(1'b0), .initial__ready(),
        .raster__payload(rgb24_raster), .raster__valid(rgb24_raster_valid), .raster__ready(rgb24_raster_ready),
        .in_frame());
endmodule
