// The beats of a raster: their digest, and what must hold for every one.
#pragma once
#include <cstdint>

struct Layout {
    int64_t pixels, depth_bits, colour_bits, word_lsb, word_bits, line_lsb, line_bits, end_lsb, limbs;
};

enum Breach { OUTSIDE = 1, ORDER = 2, EMPTY = 4, STREAM = 8, STRAY = 16, TOO_MANY = 32 };

inline uint64_t field(const uint64_t *limbs, int64_t lsb, int64_t width) {
    const int64_t limb = lsb / 64, shift = lsb % 64;
    uint64_t bits = limbs[limb] >> shift;
    if (shift + width > 64) bits |= limbs[limb + 1] << (64 - shift);
    return bits & (width == 64 ? ~uint64_t(0) : (uint64_t(1) << width) - 1);
}

// The same as `digest` of digests.py.
inline uint64_t mix(uint64_t digest, uint64_t limb) {
    digest = (digest ^ limb) * 0x9E3779B97F4A7C15u;
    return digest ^ digest >> 32;
}

struct Raster {
    uint64_t digest = 1;
    int64_t beats = 0;
    int64_t position = -1;

    // Take a beat; return the breaches of the contract. Columns and lines are less 1.
    int64_t take(const uint64_t *limbs, const Layout &l, int64_t last_column, int64_t last_line) {
        if (field(limbs, l.end_lsb, 1)) return 0;
        for (int64_t n = 0; n < l.limbs; n++) digest = mix(digest, limbs[n]);
        beats++;
        const int64_t word = field(limbs, l.word_lsb, l.word_bits);
        const int64_t line = field(limbs, l.line_lsb, l.line_bits);
        int64_t breaches = line > last_line || word * l.pixels > last_column ? OUTSIDE : 0;
        const int64_t here = line << l.word_bits | word;
        if (here <= position) breaches |= ORDER;
        position = here;
        const uint64_t background = (uint64_t(1) << l.depth_bits) - 1;
        bool drawn = false;
        for (int64_t n = 0; n < l.pixels; n++) {
            const bool there = field(limbs, n * l.depth_bits, l.depth_bits) != background;
            drawn |= there;
            if (there && word * l.pixels + n > last_column) breaches |= OUTSIDE;
            const int64_t colour = l.pixels * l.depth_bits + n * l.colour_bits;
            if (!there && field(limbs, colour, l.colour_bits)) breaches |= EMPTY;
        }
        return drawn ? breaches : breaches | EMPTY;
    }
};
