// The clocks of a board, and a recorder of its HDMI pins.
//
// Each bit on the pins becomes four bits of the record: data0, data1, data2 and clock, from bit 0 on.
// A 64-bit little-endian word of the file has sixteen of them, the first in its low bits.

`timescale 1ns / 1ps

module board_bench (
    input rst,
    input serial_rx,
    output serial_tx,
    input record,
    output [31:0] bits
);
  reg clk_sys = 0, clk_hdmi = 0, clk_hdmi5x = 0;
  wire hdmi_clk, hdmi_0, hdmi_1, hdmi_2;

  real sys_half = 10.0;  // half a period of the system's clock, ns: +sys_half=
  real bit_time = 4.0;  // of a bit on the HDMI pins, ns: +bit=
  initial begin
    if ($value$plusargs("sys_half=%f", sys_half)) ;
    #3.0;  // so that the edges of the clocks never come together
    forever #(sys_half) clk_sys = ~clk_sys;
  end
  initial if ($value$plusargs("bit=%f", bit_time)) ;

  reg [1023:0] name;
  integer file = 0;
  initial if ($value$plusargs("pins=%s", name)) file = $fopen(name, "wb");

  // A bit is sampled at its end, before the edge that ends it.
  reg [2:0] half = 0;
  reg [59:0] kept = 0;
  reg [3:0] filled = 0;
  reg [31:0] recorded = 0;
  wire [3:0] pins = {hdmi_clk, hdmi_2, hdmi_1, hdmi_0};
  assign bits = recorded;
  always @(posedge record) begin
    filled = 0;
    recorded = 0;
  end
  always @(negedge record) $fflush(file);
  always #(bit_time) begin
    if (record) begin
      filled = filled + 1;
      recorded = recorded + 1;
      if (filled == 0) $fwrite(file, "%u", {pins, kept});
      kept = {pins, kept[59:4]};
    end
    clk_hdmi5x = ~clk_hdmi5x;
    half = half + 1;
    if (half == 5) begin
      clk_hdmi = ~clk_hdmi;
      half = 0;
    end
  end

  board board (
      .clk_sys(clk_sys),
      .clk_hdmi(clk_hdmi),
      .clk_hdmi5x(clk_hdmi5x),
      .clk_rst(rst),
      .serial_rx(serial_rx),
      .serial_tx(serial_tx),
      .gpdi_clk_p(hdmi_clk),
      .gpdi_data0_p(hdmi_0),
      .gpdi_data1_p(hdmi_1),
      .gpdi_data2_p(hdmi_2)
  );
endmodule
