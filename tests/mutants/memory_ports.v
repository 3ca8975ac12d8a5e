// The ports of a memory, which become ports of its module.
module memory_ports #(parameter READS = 1, WRITES = 1, ABITS = 1, WIDTH = 1) (
    input [READS*ABITS-1:0] read_address, output [READS*WIDTH-1:0] read_data,
    input [WRITES*WIDTH-1:0] write_enable, input [WRITES*ABITS-1:0] write_address,
    input [WRITES*WIDTH-1:0] write_data);
    assign read_data = 0;
endmodule
