// The ports of an engine's own top. Verilator writes two underscores as `___05F`.
#pragma once
#include "signals.h"

struct Ports {
    Vsplatline &top;
    static constexpr int kRasterLimbs = (RASTER_BITS + 63) / 64;

    explicit Ports(Vsplatline &model) : top(model) {}

    void clock(bool level) { top.clk = level; }
    void reset(bool on) { top.rst = on; }

    void word(bool valid, const Word &w) {
        top.codewords___05Fvalid = valid;
        put<WORD_BITS>(top.codewords___05Fpayload, w.data);
    }
    bool word_taken() const { return top.codewords___05Fvalid && top.codewords___05Fready; }

    void initial(bool valid, const uint64_t *limbs, uint64_t) {
        top.initial___05Fvalid = valid;
        put<RASTER_BITS>(top.initial___05Fpayload, limbs);
    }
    bool initial_taken() const { return top.initial___05Fvalid && top.initial___05Fready; }

    void write(bool valid, const Write &w) {
        top.tables___05Fvalid = valid;
        put<TABLE_BITS>(top.tables___05Fpayload, w.data);
    }
    bool write_taken() const { return top.tables___05Fvalid && top.tables___05Fready; }
    uint64_t answer() const { return 0; }

    void raster_ready(bool ready) { top.raster___05Fready = ready; }
    bool raster_valid() const { return top.raster___05Fvalid; }
    bool raster_taken() const { return top.raster___05Fvalid && top.raster___05Fready; }
    bool raster_odd(bool) const { return false; }
    void raster(uint64_t *limbs) const { get(top.raster___05Fpayload, limbs, kRasterLimbs); }

    void upset(uint64_t reg, uint64_t bit, uint64_t row) { flip(top, reg, bit, row); }

    // An end word: mode 1, four empty rows, and the bit for the end of the frame.
    static bool ends(const Word &w) {
        const uint64_t low = w.data[0];
        if (!(low & 1) || !(low >> 25 & 1)) return false;
        for (int row = 0; row < 4; row++)
            if ((low >> (1 + 6 * row) & 7) <= (low >> (4 + 6 * row) & 7)) return false;
        return true;
    }
};
