// Records of what is sent, and access to ports of any width.
#pragma once
#include <cstdint>
#include <cstring>

#include "Vsplatline.h"

struct Word {
    uint64_t data[2];
    uint64_t keep;  // AXI: a bit a byte
    uint64_t last;  // AXI
};

struct Write {
    uint64_t at;  // cycle of its phase from which on it is offered
    uint64_t data[2];
    uint64_t kind;  // AXI: strobes, and whether it is a read
};

// Bits above a port's width are cut off: Verilator takes them to be 0.
template <int BITS, typename T> void put(T &port, const uint64_t *limbs) {
    port = BITS == 64 ? limbs[0] : limbs[0] & ((uint64_t(1) << BITS % 64) - 1);
}
template <int BITS, std::size_t N> void put(VlWide<N> &port, const uint64_t *limbs) {
    for (std::size_t n = 0; n < N; n++) port[n] = limbs[n / 2] >> (32 * (n % 2));
    if (BITS % 32) port[N - 1] &= (uint32_t(1) << BITS % 32) - 1;
}

inline void get(const uint64_t &port, uint64_t *limbs, int) { limbs[0] = port; }
template <std::size_t N> void get(const VlWide<N> &port, uint64_t *limbs, int number) {
    for (int n = 0; n < number; n++) {
        limbs[n] = port[2 * n];
        if (2 * n + 1 < int(N)) limbs[n] |= uint64_t(port[2 * n + 1]) << 32;
    }
}

// Flip a bit of the model's state, between two clock edges (upsets.py).
inline void flip(Vsplatline &top, uint64_t number, uint64_t bit, uint64_t row) {
    top.upset_register = number;
    top.upset_bit = bit;
    top.upset_row = row;
    top.upset = 1;
    top.eval();
    top.upset = 0;
    top.eval();
}
