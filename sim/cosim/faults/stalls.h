// When a port waits: patterns of stalls.
#pragma once
#include <cstdint>

enum Pattern { ALWAYS, CLOSED, RANDOM, BURSTS, SHY };
enum Port { WORDS, WRITES, INITIAL, RASTER, PORTS };

struct Stall {
    int64_t pattern;
    int64_t a, b;
};

inline uint64_t scramble(uint64_t &state) {
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return state;
}

// - ALWAYS: in every cycle.
// - CLOSED: not in the `b` cycles from cycle `a` on.
// - RANDOM: with probability `a` / 256 a cycle.
// - BURSTS: `a` cycles of every `a` + `b`.
// - SHY: unless one of the other ports in the mask `b` was used in the last `a` cycles.
inline bool unstalled(const Stall &s, int port, int64_t cycle, const int64_t *used, uint64_t &random) {
    switch (s.pattern) {
    case CLOSED: return cycle < s.a || cycle >= s.a + s.b;
    case RANDOM: return int64_t(scramble(random) >> 20 & 255) < s.a;
    case BURSTS: return (cycle + 5 * port) % (s.a + s.b) < s.a;
    case SHY:
        for (int other = 0; other < PORTS; other++)
            if (other != port && s.b >> other & 1 && cycle - used[other] <= s.a) return false;
        return true;
    default: return true;
    }
}
