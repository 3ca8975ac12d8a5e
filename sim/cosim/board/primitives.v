// Behaviour of the ECP5 cells that LiteX instantiates, after Lattice's ECP5 library guide (FPGA-TN-02032)
// and the ECP5 high-speed I/O guide (FPGA-TN-02035). Without delays.

// Two bits a clock cycle: D0 while the clock is high, then D1.
module ODDRX1F (input SCLK, input RST, input D0, input D1, output Q);
  reg first = 0, second = 0;
  always @(posedge SCLK) begin
    first <= D0;
    second <= D1;
  end
  assign Q = SCLK ? first : second;
endmodule

// A flip-flop with an asynchronous preset, for resets.
module FD1S3BX (input D, input PD, input CK, output reg Q);
  initial Q = 1;
  always @(posedge CK or posedge PD)
    if (PD) Q <= 1;
    else Q <= D;
endmodule
