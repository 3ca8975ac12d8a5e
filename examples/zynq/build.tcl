# UNTESTED: no Vivado has run this file. Its syntax, and the names of the engine's ports, are tested.
#
# A block design for a Zynq 7000: the AXI top of preset rgb24, an AXI DMA and the processor.
#
#   splatline verilog --preset rgb24 --top axi --name splatline_axi -o splatline_axi.v
#   vivado -mode batch -source build.tcl -tclargs PART [BOARD_PART]
#
# PART is for example xc7z020clg400-1. BOARD_PART sets the DDR memory's times: without it, set those
# of PS7 by hand before the hardware is used.
#
# Address map, as the processor sees it:
#
#   0x4040_0000  64 KiB  axi_dma: MM2S sends code words, S2MM takes the raster
#   0x43C0_0000  16 KiB  the engine's registers (docs/registers.md), 14 bits of address
#   0x0000_0000          DDR memory through S_AXI_HP0, for the DMA alone
#
# Interrupts of IRQ_F2P: 0 the engine, 1 MM2S, 2 S2MM (61, 62 and 63 of the GIC).
#
# In DDR a code word has 8 bytes and a beat 32. The length of a frame's transfer is 8 * code words;
# that of S2MM is as large as the largest raster, and its LENGTH register says afterwards how many
# bytes came. The caches of the processor are not coherent with HP0: flush and invalidate.

set part [lindex $argv 0]
set board [lindex $argv 1]
set clock_mhz 75

create_project -force splatline_zynq splatline_zynq -part $part
if {$board ne ""} {
    set_property board_part $board [current_project]
}
add_files splatline_axi.v
update_compile_order -fileset sources_1
create_bd_design system

# The processor: one master, one slave port of high performance, a clock, interrupts.
create_bd_cell -type ip -vlnv xilinx.com:ip:processing_system7 ps7
apply_bd_automation -rule xilinx.com:bd_rule:processing_system7 \
    -config [list make_external "FIXED_IO, DDR" apply_board_preset [expr {$board ne ""}]] \
    [get_bd_cells ps7]
set_property -dict [list \
    CONFIG.PCW_USE_M_AXI_GP0 1 \
    CONFIG.PCW_USE_S_AXI_HP0 1 \
    CONFIG.PCW_S_AXI_HP0_DATA_WIDTH 64 \
    CONFIG.PCW_USE_FABRIC_INTERRUPT 1 \
    CONFIG.PCW_IRQ_F2P_INTR 1 \
    CONFIG.PCW_FPGA0_PERIPHERAL_FREQMHZ $clock_mhz \
] [get_bd_cells ps7]
create_bd_cell -type ip -vlnv xilinx.com:ip:proc_sys_reset reset

# The engine. Vivado finds its interfaces by the names of the ports.
create_bd_cell -type module -reference splatline_axi splatline_0
set_property -dict [list \
    CONFIG.ASSOCIATED_BUSIF s_axi_ctrl:s_axis_codewords:s_axis_initial:m_axis_raster \
    CONFIG.ASSOCIATED_RESET aresetn \
] [get_bd_pins splatline_0/aclk]

# Streams as wide as the engine's. `s_axis_initial` stays open: every frame starts from background.
# A second DMA of 256 bits with MM2S alone would feed it.
create_bd_cell -type ip -vlnv xilinx.com:ip:axi_dma axi_dma
set_property -dict [list \
    CONFIG.c_include_sg 0 \
    CONFIG.c_sg_length_width 26 \
    CONFIG.c_m_axi_mm2s_data_width 64 \
    CONFIG.c_m_axis_mm2s_tdata_width 64 \
    CONFIG.c_mm2s_burst_size 16 \
    CONFIG.c_m_axi_s2mm_data_width 256 \
    CONFIG.c_s_axis_s2mm_tdata_width 256 \
    CONFIG.c_s2mm_burst_size 16 \
] [get_bd_cells axi_dma]
connect_bd_intf_net [get_bd_intf_pins axi_dma/M_AXIS_MM2S] [get_bd_intf_pins splatline_0/s_axis_codewords]
connect_bd_intf_net [get_bd_intf_pins splatline_0/m_axis_raster] [get_bd_intf_pins axi_dma/S_AXIS_S2MM]

# The processor's master reaches both sets of registers; the DMA reaches the memory.
create_bd_cell -type ip -vlnv xilinx.com:ip:smartconnect control
set_property -dict [list CONFIG.NUM_SI 1 CONFIG.NUM_MI 2] [get_bd_cells control]
connect_bd_intf_net [get_bd_intf_pins ps7/M_AXI_GP0] [get_bd_intf_pins control/S00_AXI]
connect_bd_intf_net [get_bd_intf_pins control/M00_AXI] [get_bd_intf_pins splatline_0/s_axi_ctrl]
connect_bd_intf_net [get_bd_intf_pins control/M01_AXI] [get_bd_intf_pins axi_dma/S_AXI_LITE]
create_bd_cell -type ip -vlnv xilinx.com:ip:smartconnect memory
set_property -dict [list CONFIG.NUM_SI 2 CONFIG.NUM_MI 1] [get_bd_cells memory]
connect_bd_intf_net [get_bd_intf_pins axi_dma/M_AXI_MM2S] [get_bd_intf_pins memory/S00_AXI]
connect_bd_intf_net [get_bd_intf_pins axi_dma/M_AXI_S2MM] [get_bd_intf_pins memory/S01_AXI]
connect_bd_intf_net [get_bd_intf_pins memory/M00_AXI] [get_bd_intf_pins ps7/S_AXI_HP0]

# One clock for everything. A reset of one cycle is enough for the engine; this one is longer.
connect_bd_net [get_bd_pins ps7/FCLK_CLK0] \
    [get_bd_pins ps7/M_AXI_GP0_ACLK] [get_bd_pins ps7/S_AXI_HP0_ACLK] \
    [get_bd_pins reset/slowest_sync_clk] [get_bd_pins splatline_0/aclk] \
    [get_bd_pins control/aclk] [get_bd_pins memory/aclk] \
    [get_bd_pins axi_dma/s_axi_lite_aclk] \
    [get_bd_pins axi_dma/m_axi_mm2s_aclk] [get_bd_pins axi_dma/m_axi_s2mm_aclk]
connect_bd_net [get_bd_pins ps7/FCLK_RESET0_N] [get_bd_pins reset/ext_reset_in]
connect_bd_net [get_bd_pins reset/peripheral_aresetn] \
    [get_bd_pins splatline_0/aresetn] [get_bd_pins axi_dma/axi_resetn] \
    [get_bd_pins control/aresetn] [get_bd_pins memory/aresetn]

create_bd_cell -type ip -vlnv xilinx.com:ip:xlconcat interrupts
set_property CONFIG.NUM_PORTS 3 [get_bd_cells interrupts]
connect_bd_net [get_bd_pins splatline_0/irq] [get_bd_pins interrupts/In0]
connect_bd_net [get_bd_pins axi_dma/mm2s_introut] [get_bd_pins interrupts/In1]
connect_bd_net [get_bd_pins axi_dma/s2mm_introut] [get_bd_pins interrupts/In2]
connect_bd_net [get_bd_pins interrupts/dout] [get_bd_pins ps7/IRQ_F2P]

assign_bd_address -offset 0x43C00000 -range 16K [get_bd_addr_segs splatline_0/s_axi_ctrl/*]
assign_bd_address -offset 0x40400000 -range 64K [get_bd_addr_segs axi_dma/S_AXI_LITE/Reg]
assign_bd_address
validate_bd_design
save_bd_design

make_wrapper -files [get_files system.bd] -top -import
set_property top system_wrapper [current_fileset]
launch_runs impl_1 -to_step write_bitstream -jobs 4
wait_on_run impl_1
