// Plays phases of frames to an engine, each with faults, and tells what came out.
//
// A phase is a stream of code words, table writes and an initial raster, with a pattern of stalls at
// each port, and perhaps a reset or an upset at one cycle. The engine's state lasts from phase to
// phase, and from call to call.
#include "stalls.h"
#include "beats.h"
#include PORTS_HEADER

// When a phase is played. The one before failed if it hung, or broke a rule, or its last frame was wrong.
enum Condition { ALWAYS_PLAYED, AFTER_FAILURE, UNLESS_HUNG, AFTER_WRONG };
enum Outcome { SKIPPED, DONE, HANG, RESET };

struct Phase {
    int64_t condition;           // see Condition
    int64_t reset_edges;         // before it
    int64_t words[2], writes[2], initial[2];  // first, and one past the last
    int64_t frames[2];           // of the results
    int64_t hold;                // writes that are taken before the first code word is offered
    Stall stalls[PORTS];
    int64_t reset_at, upset_at;  // cycle, or -1
    int64_t upset[3];            // number of the register, bit, row
    int64_t limit, silence;      // cycles: of the phase; without progress in unstalled cycles
    int64_t last_column, last_line;
    int64_t expected;            // digest of the last frame, 0 if it is unknown
    int64_t seed;
    int64_t flush;               // cycles after it, in which nothing may come
    int64_t optional;            // it may be over before its initial raster was taken, or within a frame
};

struct Result {
    int64_t outcome, cycles, silence, breaches, opened, closed, words, written;
};

struct Frame {
    int64_t digest, beats, offered, opened, closed;  // cycles of the first code word and of the end
};

struct Written {
    int64_t offered, cycle, opened, closed, answer;  // frames that were open and closed by then
};

static VerilatedContext context;
static Vsplatline *model = nullptr;
static Layout layout;
static bool failed = false, hung = false;

static void edge(Ports &ports) {
    ports.clock(true);
    model->eval();
    ports.clock(false);
}

static void reset(Ports &ports, int64_t edges, uint64_t &random) {
    const Word idle_word = {};
    const Write idle_write = {};
    const uint64_t idle[32] = {};
    ports.reset(true);
    for (int64_t n = 0; n < edges; n++) {
        const uint64_t bits = n + 1 < edges ? scramble(random) : 0;
        ports.word(bits & 1, idle_word);
        ports.write(false, idle_write);  // a material would be written
        ports.initial(bits & 4, idle, 0);
        ports.raster_ready(bits & 8);
        model->eval();
        edge(ports);
    }
    ports.reset(false);
}

struct Streams {
    const Word *words;
    const Write *writes;
    const uint64_t *beats;
};

struct Player {
    const Phase &p;
    const Streams &in;
    Frame *frames;
    Written *written;
    Ports ports{*model};
    Result result{};
    Raster raster;
    uint64_t random, idle[32];
    int64_t used[PORTS];
    int64_t next[3];
    int64_t since[3] = {};
    bool offered[3] = {}, in_frame = false, waiting = false;
    uint64_t held[16];

    Player(const Phase &phase, const Streams &streams, Frame *f, Written *w)
        : p(phase), in(streams), frames(f), written(w), random(phase.seed * 2 + 1) {
        for (int64_t &cycle : used) cycle = -1000000;
        next[WORDS] = p.words[0], next[WRITES] = p.writes[0], next[INITIAL] = p.initial[0];
        for (int n = 0; n < 8; n++) scramble(random);
    }

    bool more(int port, int64_t cycle) const {
        if (port == WORDS) return next[WORDS] < p.words[1] && next[WRITES] >= p.writes[0] + p.hold;
        if (port == WRITES)
            return next[WRITES] < p.writes[1] && int64_t(in.writes[next[WRITES]].at) <= cycle;
        return next[INITIAL] < p.initial[1];
    }

    // Offer what is to be offered; return whether the cycle is unstalled.
    bool drive(int64_t cycle) {
        bool all = true;
        for (int port = 0; port < RASTER; port++) {
            const bool will = unstalled(p.stalls[port], port, cycle, used, random);
            const bool there = more(port, cycle);
            if (!offered[port]) since[port] = cycle;
            offered[port] |= there && will;
            all &= !there || offered[port];
        }
        for (uint64_t &limb : idle) limb = scramble(random);
        Word nothing{{idle[0], idle[1]}, idle[2], idle[3] & 1};
        Write none{0, {idle[4], idle[5]}, 0};
        ports.word(offered[WORDS], offered[WORDS] ? in.words[next[WORDS]] : nothing);
        ports.write(offered[WRITES], offered[WRITES] ? in.writes[next[WRITES]] : none);
        const uint64_t *beat = offered[INITIAL] ? in.beats + next[INITIAL] * (layout.limbs + 1) : idle;
        ports.initial(offered[INITIAL], beat, beat[layout.limbs]);
        const bool takes = unstalled(p.stalls[RASTER], RASTER, cycle, used, random);
        ports.raster_ready(takes);
        return all && takes;
    }

    void take_word(int64_t cycle) {
        if (!in_frame) {
            if (p.frames[0] + result.opened < p.frames[1])
                frames[p.frames[0] + result.opened].opened = cycle,
                frames[p.frames[0] + result.opened].offered = since[WORDS];
            result.opened++;
        }
        in_frame = !Ports::ends(in.words[next[WORDS]]);
    }

    void take_beat(int64_t cycle) {
        uint64_t limbs[16];
        ports.raster(limbs);
        result.breaches |= raster.take(limbs, layout, p.last_column, p.last_line);
        if (result.closed >= result.opened) result.breaches |= STRAY;
        if (ports.raster_odd(field(limbs, layout.end_lsb, 1))) result.breaches |= STREAM;
        if (!field(limbs, layout.end_lsb, 1)) return;
        const int64_t at = p.frames[0] + result.closed++;
        if (at < p.frames[1]) {
            frames[at].digest = raster.digest;
            frames[at].beats = raster.beats;
            frames[at].closed = cycle;
        } else {
            result.breaches |= TOO_MANY;
        }
        raster = Raster();
    }

    // What was offered must stay.
    void check_stream() {
        uint64_t limbs[16] = {};
        const bool valid = ports.raster_valid();
        if (valid) ports.raster(limbs);
        if (waiting && (!valid || std::memcmp(limbs, held, 8 * layout.limbs))) result.breaches |= STREAM;
        waiting = valid && !ports.raster_taken();
        if (waiting) std::memcpy(held, limbs, sizeof held);
    }

    // Return whether a payload was taken.
    bool take(int64_t cycle) {
        check_stream();
        const bool took[PORTS] = {ports.word_taken(), ports.write_taken(), ports.initial_taken(),
                                  ports.raster_taken()};
        if (took[WRITES]) {
            written[next[WRITES]] = {since[WRITES], cycle, result.opened, result.closed, int64_t(ports.answer())};
            result.written++;
        }
        if (took[WORDS]) take_word(cycle);
        if (took[RASTER]) take_beat(cycle);
        bool any = false;
        for (int port = 0; port < PORTS; port++) {
            if (!took[port]) continue;
            any = true;
            used[port] = cycle;
            if (port < RASTER) next[port]++, offered[port] = false;
        }
        return any;
    }

    bool done() const {
        const bool whole = next[INITIAL] == p.initial[1] && !in_frame;
        return next[WORDS] == p.words[1] && next[WRITES] == p.writes[1] && (whole || p.optional) &&
               result.closed >= result.opened;
    }

    // Whether there is something to do.
    bool busy() const {
        return offered[WORDS] || offered[WRITES] || result.closed < result.opened;
    }

    Result run() {
        if (p.reset_edges) reset(ports, p.reset_edges, random);
        int64_t silent = 0, cycle = 0, over = -1;
        for (; cycle < p.limit; cycle++) {
            if (cycle == p.reset_at) {
                result.outcome = RESET;
                break;
            }
            if (cycle == p.upset_at) ports.upset(p.upset[0], p.upset[1], p.upset[2]);
            const bool all = drive(cycle);
            model->eval();
            const bool took = take(cycle);
            edge(ports);
            if (over < 0 && done()) over = cycle, result.cycles = cycle + 1;
            if (over >= 0 && cycle - over >= p.flush) {
                result.outcome = DONE;
                break;
            }
            silent = took || !busy() ? 0 : silent + all;
            if (silent > result.silence) result.silence = silent;
            if (silent > p.silence) break;
        }
        if (result.outcome != DONE) result.cycles = cycle;
        if (!result.outcome) result.outcome = HANG;
        result.words = next[WORDS] - p.words[0];
        return result;
    }
};

extern "C" void play(const int64_t *numbers, const Phase *phases, int64_t count, const Word *words,
                     const Write *writes, const uint64_t *beats, Result *results, Frame *frames,
                     Written *written) {
    std::memcpy(&layout, numbers, sizeof layout);
    if (!model) {
        model = new Vsplatline(&context);
        model->eval();  // the first one sees no edges
    }
    const Streams streams{words, writes, beats};
    for (int64_t n = 0; n < count; n++) {
        const Phase &phase = phases[n];
        if (phase.condition == AFTER_FAILURE && !failed) continue;
        if (phase.condition == UNLESS_HUNG && hung) continue;
        if (phase.condition == AFTER_WRONG && (hung || !failed)) continue;
        Player player(phase, streams, frames, written);
        results[n] = player.run();
        const int64_t last = phase.frames[0] + results[n].closed - 1;
        hung = results[n].outcome == HANG;
        failed = hung || results[n].breaches ||
                 (phase.expected && (last < phase.frames[0] || last >= phase.frames[1] ||
                                     frames[last].digest != phase.expected));
    }
}
