// The clocks of a board with a model of its SDRAM and PHY, and a record of its HDMI pins. With RGMII
// defined its link is Ethernet, and else a serial one.

`timescale 1ns / 1ps

module board_bench (
    input rst,
`ifdef RGMII
    output reg eth_rx_clk,
    input eth_rx_ctl,
    input [3:0] eth_rx_data,
    output eth_tx_clk,
    output eth_tx_ctl,
    output [3:0] eth_tx_data,
`else
    input serial_rx,
    output serial_tx,
`endif
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

  reg [2:0] half = 0;
  wire [3:0] pins = {hdmi_clk, hdmi_2, hdmi_1, hdmi_0};
  `include "record_pins.vh"
  always #(bit_time) begin
    sample_pins;
    clk_hdmi5x = ~clk_hdmi5x;
    half = half + 1;
    if (half == 5) begin
      clk_hdmi = ~clk_hdmi;
      half = 0;
    end
  end

`ifdef RGMII
  // The clock of received data, and that of sent data as the PHY chip delays it within.
  wire tx_clk;
  assign #2.0 eth_tx_clk = tx_clk;
  initial begin
    eth_rx_clk = 0;
    #1.1;
    forever #4.0 eth_rx_clk = ~eth_rx_clk;
  end
`endif

  board board (
      .clk_sys(clk_sys),
      .clk_hdmi(clk_hdmi),
      .clk_hdmi5x(clk_hdmi5x),
      .clk_rst(rst),
`ifdef RGMII
      .eth_clocks_rx(eth_rx_clk),
      .eth_clocks_tx(tx_clk),
      .eth_rx_ctl(eth_rx_ctl),
      .eth_rx_data(eth_rx_data),
      .eth_tx_ctl(eth_tx_ctl),
      .eth_tx_data(eth_tx_data),
`else
      .serial_rx(serial_rx),
      .serial_tx(serial_tx),
`endif
      .gpdi_clk_p(hdmi_clk),
      .gpdi_data0_p(hdmi_0),
      .gpdi_data1_p(hdmi_1),
      .gpdi_data2_p(hdmi_2)
  );
endmodule
