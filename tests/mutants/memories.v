// Memories as boxes, for proofs: what goes in is compared where it counts, and what comes out is any, the same for both
// designs. So two designs are equal if what goes into their memories is. `renamed.py` changes the two lines with
// addresses: memories that differ in the places of their words are equal as well.
(* techmap_celltype = "$mem_v2" *)
module memory_box (RD_CLK, RD_EN, RD_ARST, RD_SRST, RD_ADDR, RD_DATA, WR_CLK, WR_EN, WR_ADDR, WR_DATA);
    parameter MEMID = "";
    parameter signed SIZE = 4;
    parameter signed OFFSET = 0;
    parameter signed ABITS = 2;
    parameter signed WIDTH = 8;
    parameter signed INIT = 1'bx;
    parameter signed RD_PORTS = 1;
    parameter RD_CLK_ENABLE = 1'b1;
    parameter RD_CLK_POLARITY = 1'b1;
    parameter RD_TRANSPARENCY_MASK = 1'b0;
    parameter RD_COLLISION_X_MASK = 1'b0;
    parameter RD_WIDE_CONTINUATION = 1'b0;
    parameter RD_CE_OVER_SRST = 1'b0;
    parameter RD_ARST_VALUE = 1'b0;
    parameter RD_SRST_VALUE = 1'b0;
    parameter RD_INIT_VALUE = 1'b0;
    parameter signed WR_PORTS = 1;
    parameter WR_CLK_ENABLE = 1'b1;
    parameter WR_CLK_POLARITY = 1'b1;
    parameter WR_PRIORITY_MASK = 1'b0;
    parameter WR_WIDE_CONTINUATION = 1'b0;
    input [RD_PORTS-1:0] RD_CLK, RD_EN, RD_ARST, RD_SRST;
    input [RD_PORTS*ABITS-1:0] RD_ADDR;
    output [RD_PORTS*WIDTH-1:0] RD_DATA;
    input [WR_PORTS-1:0] WR_CLK;
    input [WR_PORTS*WIDTH-1:0] WR_EN, WR_DATA;
    input [WR_PORTS*ABITS-1:0] WR_ADDR;

    wire [RD_PORTS*ABITS-1:0] read;
    wire [WR_PORTS*ABITS-1:0] written;
    genvar n;
    generate
        for (n = 0; n < RD_PORTS; n = n + 1)
            assign read[n*ABITS +: ABITS] = RD_EN[n] ? RD_ADDR[n*ABITS +: ABITS] : 0;
        for (n = 0; n < WR_PORTS; n = n + 1)
            assign written[n*ABITS +: ABITS] = |WR_EN[n*WIDTH +: WIDTH] ? WR_ADDR[n*ABITS +: ABITS] : 0;
    endgenerate
    memory_ports #(.READS(RD_PORTS), .WRITES(WR_PORTS), .ABITS(ABITS), .WIDTH(WIDTH)) _TECHMAP_REPLACE_ (
        .read_address(read), .read_data(RD_DATA),
        .write_enable(WR_EN), .write_address(written), .write_data(WR_DATA & WR_EN));
endmodule
