// A ULX3S: its oscillator and SDRAM about the gateware as it is routed.

`timescale 1ns / 1ps

module ulx3s_bench (
    input rst,
    input serial_rx,
    output serial_tx,
    input record,
    output [31:0] bits,
    output [31:0] violations
);
  reg clk25 = 0;
  always #20 clk25 = ~clk25;

  wire sdram_clock, cke, cs_n, ras_n, cas_n, we_n;
  wire [12:0] a;
  wire [1:0] ba, dm;
  wire [15:0] dq;
  wire hdmi_clk, hdmi_0, hdmi_1, hdmi_2;
  wire [3:0] pins = {hdmi_clk, hdmi_2, hdmi_1, hdmi_0};
  `include "record_pins.vh"

  // The video PLL's edges come at multiples of 4 ns, and PAD_OUT later at the pins.
  initial begin
    #2.9;
    forever begin
      sample_pins;
      #4;
    end
  end

  sdram_chip chip (
      .clk(sdram_clock), .cke(cke), .cs_n(cs_n), .ras_n(ras_n), .cas_n(cas_n), .we_n(we_n),
      .ba(ba), .a(a), .dqm(dm), .dq(dq), .violations(violations)
  );

  board board (
      .clk25(clk25),
      .rst(rst),
      .serial_rx(serial_rx),
      .serial_tx(serial_tx),
      .wifi_gpio0(),
      .sdram_clock(sdram_clock),
      .sdram_cke(cke),
      .sdram_cs_n(cs_n),
      .sdram_ras_n(ras_n),
      .sdram_cas_n(cas_n),
      .sdram_we_n(we_n),
      .sdram_ba(ba),
      .sdram_a(a),
      .sdram_dm(dm),
      .sdram_dq(dq),
      .gpdi_clk_p(hdmi_clk),
      .gpdi_data0_p(hdmi_0),
      .gpdi_data1_p(hdmi_1),
      .gpdi_data2_p(hdmi_2)
  );
endmodule
