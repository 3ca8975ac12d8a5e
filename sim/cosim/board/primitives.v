// Behaviour of the ECP5 cells that LiteX instantiates, after Lattice's ECP5 library guide (FPGA-TN-02032)
// and the ECP5 high-speed I/O guide (FPGA-TN-02035). Without delays,
// but for those of pins where PAD_OUT and PAD_IN tell them in ns.

// Two bits a clock cycle: D0 while the clock is high, then D1.
module ODDRX1F (input SCLK, input RST, input D0, input D1, output Q);
  reg first = 0, second = 0;
  always @(posedge SCLK) begin
    first <= D0;
    second <= D1;
  end
`ifdef PAD_OUT
  reg late = 0;
  always @(first or second or SCLK) late <= #(`PAD_OUT) (SCLK ? first : second);
  assign Q = late;
`else
  assign Q = SCLK ? first : second;
`endif
endmodule

// Two bits a clock cycle: those at the rising and at the falling edge, both from the next rising
// edge on.
module IDDRX1F (input SCLK, input RST, input D, output reg Q0, output reg Q1);
  reg rising = 0, falling = 0;
  always @(posedge SCLK) begin
    rising <= D;
    Q0 <= rising;
    Q1 <= falling;
  end
  always @(negedge SCLK) falling <= D;
endmodule

// A delay that makes up for the way of the clock, which has none here.
module DELAYG #(parameter DEL_MODE = "SCLK_ALIGNED", DEL_VALUE = 0) (input A, output Z);
  assign Z = A;
endmodule

// A flip-flop with an asynchronous preset, for resets.
module FD1S3BX (input D, input PD, input CK, output reg Q);
  initial Q = 1;
  always @(posedge CK or posedge PD)
    if (PD) Q <= 1;
    else Q <= D;
endmodule

`ifdef PAD_OUT
// Flip-flops at pins, and pins of both directions, with the delays of the pins.

module OFS1P3BX (input D, input PD, input SP, input SCLK, output reg Q);
  always @(posedge SCLK) if (PD) Q <= #(`PAD_OUT) 1; else if (SP) Q <= #(`PAD_OUT) D;
endmodule

module IFS1P3BX (input D, input PD, input SP, input SCLK, output reg Q);
  reg late = 0;
  always @(D) late <= #(`PAD_IN) D;
  always @(posedge SCLK) if (PD) Q <= 1; else if (SP) Q <= late;
endmodule

module TRELLIS_IO #(parameter DIR = "BIDIR") (inout B, input I, input T, output O);
  assign B = T ? 1'bz : I;
  assign O = B;
endmodule

`endif

// The PLL: it locks 100 ns after its reset; from then on all outputs run, CLKOP without a phase.
module EHXPLLL #(
    parameter CLKI_DIV = 1, CLKFB_DIV = 1, FEEDBK_PATH = "INT_OP",
    parameter CLKOP_ENABLE = "DISABLED", CLKOS_ENABLE = "DISABLED",
    parameter CLKOS2_ENABLE = "DISABLED", CLKOS3_ENABLE = "DISABLED",
    parameter CLKOP_DIV = 8, CLKOS_DIV = 8, CLKOS2_DIV = 8, CLKOS3_DIV = 8,
    parameter CLKOP_CPHASE = 7, CLKOS_CPHASE = 7, CLKOS2_CPHASE = 7, CLKOS3_CPHASE = 7,
    parameter CLKOP_FPHASE = 0, CLKOS_FPHASE = 0, CLKOS2_FPHASE = 0, CLKOS3_FPHASE = 0,
    parameter real INPUT_NS = 40.0  // period of CLKI
) (
    input CLKI, input RST, input STDBY,
    output CLKOP, output CLKOS, output CLKOS2, output CLKOS3, output reg LOCK
);
  localparam FEEDBACK_DIV = FEEDBK_PATH == "INT_OS3" ? CLKOS3_DIV :
      FEEDBK_PATH == "INT_OS2" ? CLKOS2_DIV : FEEDBK_PATH == "INT_OS" ? CLKOS_DIV : CLKOP_DIV;
  localparam real VCO = INPUT_NS * CLKI_DIV / (CLKFB_DIV * FEEDBACK_DIV);

  initial LOCK = 0;
  always @(posedge CLKI)
    if (RST) LOCK <= 0;
    else if (!LOCK) begin
      #100.0;
      LOCK <= 1;
    end

  pll_output #(VCO * CLKOP_DIV, VCO * (CLKOP_CPHASE + 1 - CLKOP_DIV + CLKOP_FPHASE / 8.0))
      op (.run(LOCK), .clk(CLKOP));
  pll_output #(VCO * CLKOS_DIV, VCO * (CLKOS_CPHASE + 1 - CLKOS_DIV + CLKOS_FPHASE / 8.0))
      os (.run(LOCK), .clk(CLKOS));
  pll_output #(VCO * CLKOS2_DIV, VCO * (CLKOS2_CPHASE + 1 - CLKOS2_DIV + CLKOS2_FPHASE / 8.0))
      os2 (.run(LOCK && CLKOS2_ENABLE == "ENABLED"), .clk(CLKOS2));
  pll_output #(VCO * CLKOS3_DIV, VCO * (CLKOS3_CPHASE + 1 - CLKOS3_DIV + CLKOS3_FPHASE / 8.0))
      os3 (.run(LOCK && CLKOS3_ENABLE == "ENABLED"), .clk(CLKOS3));
endmodule

// A clock that begins a phase after `run` rises.
module pll_output #(parameter real PERIOD = 10.0, parameter real PHASE = 0.0)
    (input run, output reg clk);
  initial begin
    clk = 0;
    forever begin
      wait (run);
      #(PHASE);
      while (run) begin
        clk = 1;
        #(PERIOD / 2);
        clk = 0;
        #(PERIOD / 2);
      end
    end
  end
endmodule
