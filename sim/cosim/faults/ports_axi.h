// The ports of the AXI top. A table write is an access of the register bus, which ends with its answer.
#pragma once
#include "signals.h"

struct Ports {
    Vsplatline &top;
    static constexpr int kRasterLimbs = (RASTER_BITS + 63) / 64;
    static constexpr uint64_t kRead = 16;  // of `Write::kind`, above the strobes
    bool addressed = false, given = false, reading = false;

    explicit Ports(Vsplatline &model) : top(model) {}

    void clock(bool level) { top.aclk = level; }
    void reset(bool on) { top.aresetn = !on; }

    void word(bool valid, const Word &w) {
        top.s_axis_codewords_tvalid = valid;
        put<WORD_BYTES * 8>(top.s_axis_codewords_tdata, w.data);
        put<WORD_BYTES>(top.s_axis_codewords_tkeep, &w.keep);
        top.s_axis_codewords_tlast = w.last & 1;
    }
    bool word_taken() const { return top.s_axis_codewords_tvalid && top.s_axis_codewords_tready; }

    // `flags`: bit 0 is TLAST; of a word with bit 1 set a byte is missing.
    void initial(bool valid, const uint64_t *limbs, uint64_t flags) {
        uint64_t padded[32] = {};
        std::memcpy(padded, limbs, 8 * kRasterLimbs);
        const uint64_t keep[2] = {~uint64_t(flags & 2), ~uint64_t(0)};
        top.s_axis_initial_tvalid = valid;
        put<BEAT_BYTES * 8>(top.s_axis_initial_tdata, padded);
        put<BEAT_BYTES>(top.s_axis_initial_tkeep, keep);
        top.s_axis_initial_tlast = flags & 1;
    }
    bool initial_taken() const { return top.s_axis_initial_tvalid && top.s_axis_initial_tready; }

    void write(bool valid, const Write &w) {
        reading = w.kind & kRead;
        const uint64_t address = w.data[0] & ADDRESS_MASK;
        top.s_axi_ctrl_awaddr = top.s_axi_ctrl_araddr = address;
        top.s_axi_ctrl_wdata = w.data[0] >> 32;
        top.s_axi_ctrl_wstrb = w.kind & 15;
        top.s_axi_ctrl_awvalid = valid && !reading && !addressed;
        top.s_axi_ctrl_wvalid = valid && !reading && !given;
        top.s_axi_ctrl_arvalid = valid && reading && !addressed;
        top.s_axi_ctrl_bready = top.s_axi_ctrl_rready = 1;
    }
    // Once a cycle, after it has settled.
    bool write_taken() {
        addressed |= (top.s_axi_ctrl_awvalid && top.s_axi_ctrl_awready) ||
                     (top.s_axi_ctrl_arvalid && top.s_axi_ctrl_arready);
        given |= top.s_axi_ctrl_wvalid && top.s_axi_ctrl_wready;
        if (!top.s_axi_ctrl_bvalid && !top.s_axi_ctrl_rvalid) return false;
        addressed = given = false;
        return true;
    }
    // The response above 32 bits of data.
    uint64_t answer() const {
        if (reading) return uint64_t(top.s_axi_ctrl_rresp) << 32 | top.s_axi_ctrl_rdata;
        return uint64_t(top.s_axi_ctrl_bresp) << 32;
    }

    void raster_ready(bool ready) { top.m_axis_raster_tready = ready; }
    bool raster_valid() const { return top.m_axis_raster_tvalid; }
    bool raster_taken() const { return top.m_axis_raster_tvalid && top.m_axis_raster_tready; }
    void raster(uint64_t *limbs) const { get(top.m_axis_raster_tdata, limbs, kRasterLimbs); }
    // TLAST comes with the end beat, and every byte is there.
    bool raster_odd(bool end) const {
        const uint64_t all = BEAT_BYTES == 64 ? ~uint64_t(0) : (uint64_t(1) << BEAT_BYTES % 64) - 1;
        return top.m_axis_raster_tlast != end || uint64_t(top.m_axis_raster_tkeep) != all;
    }

    void upset(uint64_t reg, uint64_t bit, uint64_t row) { flip(top, reg, bit, row); }

    // A packet becomes a frame.
    static bool ends(const Word &w) { return w.last & 1; }
};
