// A record of the HDMI pins: included by a bench that has `record`, `bits` and the wires `pins`.
//
// Each bit on the pins becomes four bits of the file: data0, data1, data2 and clock, from bit 0 on.
// A 64-bit little-endian word of the file has sixteen of them, the first in its low bits.

reg [1023:0] record_name;
integer record_file = 0;
initial if ($value$plusargs("pins=%s", record_name)) record_file = $fopen(record_name, "wb");

reg [59:0] record_kept = 0;
reg [3:0] record_filled = 0;
reg [31:0] record_bits = 0;
assign bits = record_bits;

always @(posedge record) begin
  record_filled = 0;
  record_bits = 0;
end
always @(negedge record) $fflush(record_file);

// To be called at the end of each bit, before the edge that ends it.
task sample_pins;
  if (record) begin
    record_filled = record_filled + 1;
    record_bits = record_bits + 1;
    if (record_filled == 0) $fwrite(record_file, "%u", {pins, record_kept});
    record_kept = {pins, record_kept[59:4]};
  end
endtask
