// An SDR SDRAM of 4 banks x 8192 rows x 512 columns x 16 bits, after the data sheet of Micron's
// MT48LC16M16A2: commands, bursts, CAS latency, byte masks, and a count of broken rules.
//
// Times are those of the speed grade -7E. Outside of the time in which read data are valid, the chip
// drives their inverse.

`timescale 1ns / 1ps

module sdram_chip #(
    parameter real ACCESS = 5.4,  // tAC: from the clock to read data, at most
    parameter real HOLD = 2.7,  // tOH: read data stay behind the next clock
    parameter real T_RCD = 15.0, T_RP = 15.0, T_RAS = 37.0, T_RC = 60.0, T_RFC = 66.0, T_WR = 14.0,
    parameter real REFRESH = 64.0e6 / 8192.0,  // mean time between two refreshes
    parameter real LATE = 8.0  // refreshes that may be put off; counted from the first access on
) (
    input clk,
    input cke,
    input cs_n,
    input ras_n,
    input cas_n,
    input we_n,
    input [1:0] ba,
    input [12:0] a,
    input [1:0] dqm,
    inout [15:0] dq,
    output reg [31:0] violations
);
  localparam MODE = 3'b000, AUTO_REFRESH = 3'b001, PRECHARGE = 3'b010, ACTIVATE = 3'b011;
  localparam WRITE = 3'b100, READ = 3'b101, NOP = 3'b111;

  reg [15:0] cells[0:16777215];
  reg [12:0] row[0:3];
  reg [3:0] open = 0;
  real opened[0:3], closed[0:3], written[0:3];
  real refreshed, due;
  reg ready = 0;  // the mode is set
  reg used = 0;  // and a row was opened
  integer refreshes = 0;
  reg [2:0] latency = 0;
  reg [3:0] burst = 0;

  // The burst that goes on, and read data on their way.
  reg [3:0] left = 0;
  reg writing = 0;
  reg precharges = 0;  // the bank closes behind the burst
  reg [23:0] address = 0;
  reg [1:0] bank = 0;
  reg [15:0] pipe[0:3];
  reg [3:0] pipe_valid = 0;
  integer n;

  reg driven = 0, settled = 0;
  reg [15:0] value = 0;
  assign dq = driven ? (settled ? value : ~value) : 16'hzzzz;

  task broken(input [8*24-1:0] rule);
    begin
      violations = violations + 1;
      if (violations < 20) $display("SDRAM, %0t ns: %0s", $realtime, rule);
    end
  endtask

  initial begin
    violations = 0;
    due = 0;
    refreshed = -1000;
    for (n = 0; n < 4; n = n + 1) begin
      opened[n] = -1000;
      closed[n] = -1000;
      written[n] = -1000;
      row[n] = 0;
      pipe[n] = 0;
    end
  end

  task look_at_refresh;
    if (used && $realtime > due + LATE * REFRESH) broken("refresh is late");
  endtask

  task start_burst(input write);
    begin
      look_at_refresh;
      if (!open[ba]) broken("access to a closed bank");
      if ($realtime - opened[ba] < T_RCD) broken("tRCD");
      if (!ready) broken("access before the mode is set");
      address = {ba, row[ba], a[8:0]};
      bank = ba;
      left = burst;
      writing = write;
      precharges = a[10];
    end
  endtask

  task close(input [1:0] which);
    if (open[which]) begin
      if ($realtime - opened[which] < T_RAS) broken("tRAS");
      if ($realtime - written[which] < T_WR) broken("tWR");
      open[which] = 0;
      closed[which] = $realtime;
    end
  endtask

  always @(posedge clk) begin
    if (cke && !cs_n)
      case ({ras_n, cas_n, we_n})
        MODE: begin
          if (open != 0) broken("mode while a bank is open");
          latency = a[6:4];
          burst = 1 << a[2:0];
          ready = refreshes >= 2;
          used = 0;
        end
        AUTO_REFRESH: begin
          if (open != 0) broken("refresh while a bank is open");
          for (n = 0; n < 4; n = n + 1) if ($realtime - closed[n] < T_RP) broken("tRP, refresh");
          look_at_refresh;
          due = due + REFRESH;
          refreshed = $realtime;
          refreshes = refreshes + 1;
        end
        PRECHARGE: begin
          if (a[10]) for (n = 0; n < 4; n = n + 1) close(n[1:0]);
          else close(ba);
          if (writing && (a[10] || ba == bank)) left = 0;
        end
        ACTIVATE: begin
          if (open[ba]) broken("activate of an open bank");
          if ($realtime - closed[ba] < T_RP) broken("tRP");
          if ($realtime - opened[ba] < T_RC) broken("tRC");
          if ($realtime - refreshed < T_RFC) broken("tRFC");
          if (!used) due = $realtime + REFRESH;
          used = 1;
          open[ba] = 1;
          row[ba] = a;
          opened[ba] = $realtime;
        end
        WRITE: start_burst(1);
        READ: start_burst(0);
        NOP: ;
        default: broken("unknown command");
      endcase

    // With a CAS latency of n the first word of a burst is taken at the n-th edge behind its command.
    for (n = 0; n < 3; n = n + 1) pipe[n] = pipe[n+1];
    pipe_valid = pipe_valid >> 1;
    if (left != 0) begin
      if (writing) begin
        if (!dqm[0]) cells[address][7:0] = dq[7:0];
        if (!dqm[1]) cells[address][15:8] = dq[15:8];
        written[bank] = $realtime;
        if (driven) broken("both drive the data");
      end else begin
        pipe[latency-1] = cells[address];
        pipe_valid[latency-1] = 1;
      end
      // Within the burst the column wraps.
      if (burst == 2) address[0] = ~address[0];
      else address[8:0] = address[8:0] + 1;
      left = left - 1;
      if (left == 0 && precharges) begin
        open[bank] = 0;
        closed[bank] = $realtime + (writing ? T_WR : 0.0);
        if (closed[bank] < opened[bank] + T_RAS) closed[bank] = opened[bank] + T_RAS;
      end
    end

    // They are there some time after the edge before the one at which they are taken.
    settled <= #(HOLD) 0;
    driven <= #(HOLD + 0.1) pipe_valid[0];
    value <= #(HOLD + 0.1) pipe[0];
    settled <= #(ACCESS) pipe_valid[0];
  end
endmodule
