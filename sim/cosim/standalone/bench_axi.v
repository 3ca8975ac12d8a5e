// Plays frames to the AXI top and compares every beat of its raster with what the golden renderer says.
//
// Prints PASS and ends with exit code 0, or prints FAIL with the first unlike beat and ends with exit code 1.
// bench_sizes.vh, beside it, has the top's name, the widths of its streams and the lengths of the files. The highest bit
// of a number in a stream's file is TLAST.
//
// The first frame starts from background, the second from the raster in initial.hex. Both are drawn twice, with a reset
// between: as fast as the top takes them, then with random gaps on every stream. While a stream's valid is 0, its
// payload is undefined. Registers are written between frames.
//
// Verilog-2005, and $fatal of SystemVerilog for the exit code.
`include "bench_sizes.vh"

module bench;
    localparam PATIENCE = 20000;  // cycles without a transfer after which the top counts as stuck
    localparam QUIET = 64;        // cycles after the last end beat in which no further beat may come

    reg clk = 0;
    reg rst = 1;
    reg gaps = 0;  // of the second pass
    always #5 clk = ~clk;

    wire write_valid, codeword_valid, codeword_ready, initial_valid, initial_ready, beat_valid;
    wire [47:0] write;  // address and data of a register
    wire [`CODEWORD_BITS:0] codeword;
    wire [`BEAT_BITS:0] initial_beat;
    wire [`BEAT_BITS-1:0] beat;
    wire [`BEAT_BITS/8-1:0] keep;
    wire last;
    reg beat_ready = 0;

    // Registers of a frame, then its code words; those of the next once the frame is out.
    wire [31:0] offered_writes, codewords, initials;  // transfers so far
    reg [31:0] written = 0;                           // answers of the bus
    reg [31:0] beats = 0;                             // taken so far
    wire drawing = beats >= `BEATS_OF_FIRST;          // the second frame
    wire [31:0] writes_due = drawing ? `WRITES : `WRITES_OF_FIRST;
    wire [31:0] codewords_due = written < writes_due ? codewords : drawing ? `CODEWORDS : `CODEWORDS_OF_FIRST;

    // Address and data go to channels of their own; a write is offered until both are taken.
    wire address_ready, data_ready, answered;
    wire [1:0] answer;
    reg address_taken = 0, data_taken = 0;
    wire address_done = address_taken || address_ready;
    wire data_done = data_taken || data_ready;
    wire write_ready = address_done && data_done;
    always @(posedge clk) begin
        address_taken <= !rst && write_valid && !write_ready && address_done;
        data_taken <= !rst && write_valid && !write_ready && data_done;
    end

    bench_source #(.WIDTH(48), .LENGTH(`WRITES), .FILE("registers.hex"), .SEED(11)) write_source (
        .clk(clk), .rst(rst), .gaps(gaps), .due(writes_due), .taken(offered_writes),
        .valid(write_valid), .payload(write), .ready(write_ready));
    bench_source #(.WIDTH(`CODEWORD_BITS + 1), .LENGTH(`CODEWORDS), .FILE("codewords.hex"), .SEED(22)) codeword_source (
        .clk(clk), .rst(rst), .gaps(gaps), .due(codewords_due), .taken(codewords),
        .valid(codeword_valid), .payload(codeword), .ready(codeword_ready));
    bench_source #(.WIDTH(`BEAT_BITS + 1), .LENGTH(`INITIALS), .FILE("initial.hex"), .SEED(33)) initial_source (
        .clk(clk), .rst(rst), .gaps(gaps), .due(drawing ? `INITIALS : 0), .taken(initials),
        .valid(initial_valid), .payload(initial_beat), .ready(initial_ready));

    `ENGINE engine (
        .aclk(clk), .aresetn(!rst), .irq(),
        .s_axi_ctrl_awaddr(write[45:32]), .s_axi_ctrl_awprot(3'd0),
        .s_axi_ctrl_awvalid(write_valid && !address_taken), .s_axi_ctrl_awready(address_ready),
        .s_axi_ctrl_wdata(write[31:0]), .s_axi_ctrl_wstrb(4'd15),
        .s_axi_ctrl_wvalid(write_valid && !data_taken), .s_axi_ctrl_wready(data_ready),
        .s_axi_ctrl_bresp(answer), .s_axi_ctrl_bvalid(answered), .s_axi_ctrl_bready(1'b1),
        .s_axi_ctrl_araddr(14'd0), .s_axi_ctrl_arprot(3'd0), .s_axi_ctrl_arvalid(1'b0), .s_axi_ctrl_arready(),
        .s_axi_ctrl_rdata(), .s_axi_ctrl_rresp(), .s_axi_ctrl_rvalid(), .s_axi_ctrl_rready(1'b1),
        .s_axis_codewords_tdata(codeword[`CODEWORD_BITS-1:0]), .s_axis_codewords_tkeep({`CODEWORD_BITS / 8{1'b1}}),
        .s_axis_codewords_tlast(codeword[`CODEWORD_BITS]), .s_axis_codewords_tvalid(codeword_valid),
        .s_axis_codewords_tready(codeword_ready),
        .s_axis_initial_tdata(initial_beat[`BEAT_BITS-1:0]), .s_axis_initial_tkeep({`BEAT_BITS / 8{1'b1}}),
        .s_axis_initial_tlast(initial_beat[`BEAT_BITS]), .s_axis_initial_tvalid(initial_valid),
        .s_axis_initial_tready(initial_ready),
        .m_axis_raster_tdata(beat), .m_axis_raster_tkeep(keep), .m_axis_raster_tlast(last),
        .m_axis_raster_tvalid(beat_valid), .m_axis_raster_tready(beat_ready));

    reg [`BEAT_BITS:0] expected [0:`BEATS-1];
    initial $readmemh("raster.hex", expected);
    // Of an end beat no bit but the end bit counts.
    wire ends = expected[beats][`BEAT_BITS];
    wire unlike = last !== ends || keep !== {`BEAT_BITS / 8{1'b1}}
        || (ends ? beat[`END_BIT] !== 1 : beat !== expected[beats][`BEAT_BITS-1:0]);

    reg [31:0] random = 32'd44;
    reg [31:0] idle = 0;       // cycles since the last transfer
    reg waiting = 0;           // a beat was offered and not taken
    reg [`BEAT_BITS-1:0] offered;
    wire transfer = beat_valid && beat_ready || write_valid && write_ready || codeword_valid && codeword_ready
        || initial_valid && initial_ready;

    // Each pass begins with one clock edge in reset.
    always @(posedge clk) begin
        random <= {random[30:0], random[31] ^ random[21] ^ random[1] ^ random[0]};
        beat_ready <= !rst && (!gaps || random[8]);
        idle <= rst || transfer ? 0 : idle + 1;
        waiting <= beat_valid && !beat_ready && !rst;
        offered <= beat;
        written <= rst ? 0 : written + answered;
        if (rst) begin
            rst <= 0;
            beats <= 0;
        end else if (beat_valid !== 0 && beat_valid !== 1) fail("TVALID is undefined");
        else if (answered && answer !== 0) fail("a register was refused");
        else if (waiting && (!beat_valid || beat !== offered)) fail("a beat changed before it was taken");
        else if (beat_valid && beats == `BEATS) fail("a beat after the last frame's end");
        else if (beat_valid && beat_ready) begin
            if (unlike) begin
                $display("beat     %h", beat);
                $display("expected %h", expected[beats][`BEAT_BITS-1:0]);
                fail("an unlike beat");
            end
            beats <= beats + 1;
        end else if (beats < `BEATS && idle == PATIENCE) fail("the engine is stuck");
        else if (beats == `BEATS && idle == QUIET) begin
            if (written != `WRITES || codewords != `CODEWORDS || initials != `INITIALS)
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
