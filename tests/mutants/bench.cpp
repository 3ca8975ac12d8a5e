// Plays acts to every mutant of a design and says by which act each is noticed.
//
//   Vbench PROGRAM FIRST LAST   prints for each mutant FIRST..LAST: "number act reason cycles"; act -1: it survived.
//
// Mutant 0 is the design itself. Every mutant gets a new model. `wrap.py` writes the top module and `program.py` the
// file, in words of 32 bits: channels in, channels out, words of a payload; acts; and of each act
//   edges of reset, cycle of a reset or 0, cycles until it hangs, least and most cycles, seed, quiet cycles,
//   of each channel the rate (0..256, or 512) and the longest burst, and then its items:
//   flags, the transfers of each channel that go before it, the payload, and of an output the mask.
// Bit 31 of such a count: of an input, what is offered counts as well; an output is not ready until then.
// Flags: 1: the last item of a frame; bits 1..2: the level of the wire then, 2: any; 8: the lowest word of the payload
// is the number of cycles in which a beat of the raster has waited.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <string>
#include <vector>
#include "Vbench.h"
#include "verilated.h"

using Words = const uint32_t*;
static const uint32_t SHOWN = 1u << 31, HELD = SHOWN;  // in a count of transfers: of an input, of an output
static std::vector<uint32_t> file;
static size_t at = 0;
static unsigned inputs, outputs, payload_words, channels, codewords, raster;

static const uint32_t SHY = 512;  // for a rate

struct Channel {
    uint32_t rate, burst, count, stride;
    Words items;
    Words item(uint32_t n) const { return items + size_t(n) * stride; }
};

struct Act {
    uint32_t edges, cut, limit, least, most, seed, quiet;
    std::vector<Channel> channel;
};

static uint32_t next() { return file.at(at++); }

static std::vector<Act> read(const char* path) {
    std::ifstream in(path, std::ios::binary | std::ios::ate);
    file.resize(size_t(in.tellg()) / 4);
    in.seekg(0);
    in.read(reinterpret_cast<char*>(file.data()), std::streamsize(4 * file.size()));
    inputs = next(), outputs = next(), payload_words = next(), codewords = next(), raster = next();
    channels = inputs + outputs;
    std::vector<Act> acts(next());
    for (Act& act : acts) {
        act.edges = next(), act.cut = next(), act.limit = next(), act.least = next();
        act.most = next(), act.seed = next(), act.quiet = next();
        for (unsigned c = 0; c < channels; c++) {
            Channel one;
            one.rate = next(), one.burst = next(), one.count = next();
            one.stride = 1 + channels + payload_words * (c < inputs ? 1 : 2);
            one.items = file.data() + at;
            at += size_t(one.count) * one.stride;
            act.channel.push_back(one);
        }
    }
    return acts;
}

class Player {
    VerilatedContext context;
    std::unique_ptr<Vbench> top;
    uint64_t random = 88172645463325252ull;

    uint32_t draw() {
        random ^= random << 13, random ^= random >> 7, random ^= random << 17;
        return uint32_t(random >> 16);
    }
    // A random state that lasts up to `burst` cycles, on with the channel's rate.
    bool goes(const Channel& channel, unsigned c) {
        if (channel.rate >= 256) return true;
        if (left[c] == 0) {
            on[c] = draw() % 256 < channel.rate;
            left[c] = 1 + draw() % channel.burst;
        }
        left[c]--;
        return on[c];
    }
    void edge() {
        top->clk = 1;
        top->eval();
        top->clk = 0;
        cycles++;
    }

    std::vector<uint32_t> done, offered, left;
    std::vector<bool> on, valid, waiting;

public:
    uint64_t cycles = 0;

    explicit Player(unsigned mutant) {
        context.randReset(2);
        context.randSeed(7);
        top = std::make_unique<Vbench>(&context);
        top->mutsel = mutant;
        top->clk = 0;
    }

    void noise(unsigned c) {
        for (unsigned w = 0; w < payload_words; w++) top->in_payload[c * payload_words + w] = draw();
    }

    void reset(const Act& act) {
        top->rst = 1;
        top->eval();
        for (uint32_t e = 0; e < act.edges; e++) {
            edge();
            top->in_valid = 0;
            top->out_ready = 0;
            top->eval();
        }
        top->rst = 0;
    }

    bool before(Words gates, uint32_t kind = 0) const {
        for (unsigned c = 0; c < channels; c++)
            if ((gates[c] & HELD) == kind && done[c] < (gates[c] & ~HELD)) return false;
        return true;
    }
    bool held(const Channel& channel, unsigned c) const {
        return done[c] < channel.count && !before(channel.item(done[c]) + 1, HELD);
    }

    // Returns what is wrong, or nullptr.
    const char* play(const Act& act) {
        random = 88172645463325252ull ^ (uint64_t(act.seed) << 20);
        for (int n = 0; n < 8; n++) draw();
        if (act.edges) reset(act);
        done.assign(channels, 0), offered.assign(channels, 0), left.assign(channels, 0);
        on.assign(channels, false), valid.assign(channels, false), waiting.assign(channels, false);
        uint64_t first = 0, last = 0;
        bool open = false;
        uint32_t quiet = 0, stalls = 0;
        for (uint64_t cycle = 0;; cycle++) {
            if (act.cut && cycle == act.cut) return nullptr;
            if (cycle == act.limit) return "hang";
            uint32_t valids = 0, readies = 0;
            const std::vector<uint32_t> seen = offered;
            for (unsigned c = 0; c < inputs; c++) {
                const Channel& channel = act.channel[c];
                bool may = goes(channel, c);
                if (!valid[c]) {
                    noise(c);
                    if (may && done[c] < channel.count) {
                        Words item = channel.item(done[c]);
                        bool free = true;
                        for (unsigned o = 0; o < channels && free; o++)
                            free = item[1 + o] & SHOWN ? seen[o] >= (item[1 + o] & ~SHOWN) : done[o] >= item[1 + o];
                        if (free) {
                            valid[c] = true;
                            offered[c] = done[c] + 1;
                            for (unsigned w = 0; w < payload_words; w++)
                                top->in_payload[c * payload_words + w] = item[1 + channels + w];
                        }
                    }
                }
                valids |= uint32_t(valid[c]) << c;
            }
            for (unsigned o = 0; o < outputs; o++) {
                const Channel& channel = act.channel[inputs + o];
                // A shy one is ready once it was offered something, and a source may not wait for it.
                const bool ready = channel.rate == SHY ? bool(waiting[inputs + o]) : goes(channel, inputs + o);
                readies |= uint32_t(ready && !held(channel, inputs + o)) << o;
            }
            top->in_valid = valids;
            top->out_ready = readies;
            top->eval();
            if (top->has_in_frame && top->level != open) return "level";
            bool moved = false;
            for (unsigned o = 0; o < outputs; o++) {
                const unsigned c = inputs + o;
                const Channel& channel = act.channel[c];
                if (!(top->out_valid >> o & 1)) {
                    if (waiting[c]) return "withdrawn";
                    continue;
                }
                if (done[c] >= channel.count) return "surplus";
                Words item = channel.item(done[c]), wanted = item + 1 + channels;
                if (!before(item + 1)) return "early";
                for (unsigned w = 0; w < payload_words; w++) {
                    const uint32_t value = w == 0 && item[0] & 8 ? stalls : wanted[w];
                    if ((top->out_payload[o * payload_words + w] ^ value) & wanted[payload_words + w]) return "value";
                }
                waiting[c] = !(readies >> o & 1);
                if (o == raster) stalls += waiting[c];
                if (waiting[c]) continue;
                if ((item[0] >> 1 & 3) < 2 && top->level != (item[0] >> 1 & 3)) return "level";
                done[c]++;
                moved = true;
                if (o == raster) last = cycle;
            }
            const uint32_t ready = top->in_ready;
            for (unsigned c = 0; c < inputs; c++) {
                if (!valid[c] || !(ready >> c & 1)) continue;
                if (c == codewords) {
                    if (!done[c]) first = cycle;
                    open = !(act.channel[c].item(done[c])[0] & 1);
                }
                valid[c] = false;
                done[c]++;
                moved = true;
            }
            bool all = true;
            for (unsigned c = 0; c < channels; c++) all = all && done[c] == act.channel[c].count;
            edge();
            quiet = all && !moved ? quiet + 1 : 0;
            if (all && quiet > act.quiet) break;
        }
        const uint64_t took = last - first + 1;
        if (took < act.least || took > act.most) {
            if (getenv("SHOW")) fprintf(stderr, "%llu cycles, not %u to %u\n", (unsigned long long)took, act.least, act.most);
            return "cycles";
        }
        return nullptr;
    }

    std::string where() const {
        std::string text;
        for (uint32_t n : done) text += std::to_string(n) + ",";
        return text;
    }
};

int main(int argc, char** argv) {
    if (argc != 4) return 2;
    const std::vector<Act> acts = read(argv[1]);
    const unsigned first = unsigned(atoi(argv[2])), last = unsigned(atoi(argv[3]));
    for (unsigned mutant = first; mutant <= last; mutant++) {
        Player player(mutant);
        int act = 0;
        const char* wrong = nullptr;
        for (; act < int(acts.size()); act++)
            if ((wrong = player.play(acts[act]))) break;
        printf("%u %d %s %llu\n", mutant, wrong ? act : -1, wrong ? wrong : "-", (unsigned long long)player.cycles);
        fflush(stdout);
        if (wrong && getenv("SHOW")) fprintf(stderr, "mutant %u act %d: %s, transfers %s\n", mutant, act, wrong, player.where().c_str());
    }
    return 0;
}
