/* See splatline_driver.h.
 *
 * SPDX-License-Identifier: BSD-2-Clause */
#include "splatline_driver.h"

#define CONFIG_0                                                                                   \
    (SPLATLINE_CONFIG_0_X_BITS_RESET << SPLATLINE_CONFIG_0_X_BITS_SHIFT                            \
     | SPLATLINE_CONFIG_0_LINE_BITS_RESET << SPLATLINE_CONFIG_0_LINE_BITS_SHIFT                    \
     | SPLATLINE_CONFIG_0_DEPTH_BITS_RESET << SPLATLINE_CONFIG_0_DEPTH_BITS_SHIFT                  \
     | SPLATLINE_CONFIG_0_CHANNEL_BITS_RESET << SPLATLINE_CONFIG_0_CHANNEL_BITS_SHIFT              \
     | SPLATLINE_CONFIG_0_INTENSITY_BITS_RESET << SPLATLINE_CONFIG_0_INTENSITY_BITS_SHIFT          \
     | SPLATLINE_CONFIG_0_MATERIAL_BITS_RESET << SPLATLINE_CONFIG_0_MATERIAL_BITS_SHIFT            \
     | SPLATLINE_CONFIG_0_COEFFICIENT_BITS_RESET << SPLATLINE_CONFIG_0_COEFFICIENT_BITS_SHIFT      \
     | SPLATLINE_CONFIG_0_WINDOW_RESET << SPLATLINE_CONFIG_0_WINDOW_SHIFT)

#define CONFIG_1                                                                                   \
    (SPLATLINE_CONFIG_1_COLOUR_SHIFT_RESET << SPLATLINE_CONFIG_1_COLOUR_SHIFT_SHIFT                \
     | SPLATLINE_CONFIG_1_WINDOW_LINES_RESET << SPLATLINE_CONFIG_1_WINDOW_LINES_SHIFT              \
     | SPLATLINE_CONFIG_1_PIXELS_PER_WORD_RESET << SPLATLINE_CONFIG_1_PIXELS_PER_WORD_SHIFT        \
     | SPLATLINE_CONFIG_1_SHAPES_RESET << SPLATLINE_CONFIG_1_SHAPES_SHIFT                          \
     | SPLATLINE_CONFIG_1_RASTER_WORDS_RESET << SPLATLINE_CONFIG_1_RASTER_WORDS_SHIFT              \
     | SPLATLINE_CONFIG_1_BEAT_BYTES_RESET << SPLATLINE_CONFIG_1_BEAT_BYTES_SHIFT                  \
     | SPLATLINE_CONFIG_1_PLANE_RESET << SPLATLINE_CONFIG_1_PLANE_SHIFT                            \
     | SPLATLINE_CONFIG_1_SLOPE_BITS_RESET << SPLATLINE_CONFIG_1_SLOPE_BITS_SHIFT)

static uint32_t read32(const struct splatline *engine, uint32_t offset)
{
    return engine->bus->read32(engine->bus->context, offset);
}

static void write32(const struct splatline *engine, uint32_t offset, uint32_t value)
{
    engine->bus->write32(engine->bus->context, offset, value);
}

static void control(const struct splatline *engine, uint32_t bits)
{
    write32(engine, SPLATLINE_CONTROL_OFFSET, SPLATLINE_CONTROL_QUIET_MASK | bits);
}

/* Reads the errors and clears them. */
static enum splatline_status take_errors(struct splatline *engine)
{
    const uint32_t errors = read32(engine, SPLATLINE_ERROR_OFFSET);

    if (errors == 0)
        return SPLATLINE_OK;
    engine->errors = errors;
    write32(engine, SPLATLINE_ERROR_OFFSET, errors);
    return SPLATLINE_REFUSED;
}

enum splatline_status splatline_open(struct splatline *engine, const struct splatline_bus *bus)
{
    engine->bus = bus;
    engine->errors = 0;
    if (read32(engine, SPLATLINE_ID_OFFSET) != SPLATLINE_ID_VALUE_RESET)
        return SPLATLINE_NO_ENGINE;
    if (SPLATLINE_GET(VERSION_MAJOR, read32(engine, SPLATLINE_VERSION_OFFSET))
        != SPLATLINE_VERSION_MAJOR_RESET)
        return SPLATLINE_OTHER_VERSION;
    if (read32(engine, SPLATLINE_CONFIG_0_OFFSET) != CONFIG_0
        || read32(engine, SPLATLINE_CONFIG_1_OFFSET) != CONFIG_1)
        return SPLATLINE_OTHER_ENGINE;
    control(engine, 0);
    (void)take_errors(engine); /* those of whoever had the engine before */
    engine->errors = 0;
    return SPLATLINE_OK;
}

enum splatline_status splatline_set_size(struct splatline *engine, uint32_t width, uint32_t height)
{
    if (width == 0 || width - 1 > SPLATLINE_LAST_COLUMN_VALUE_MASK
        || height == 0 || height - 1 > SPLATLINE_LAST_LINE_VALUE_MASK)
        return SPLATLINE_BAD_ARGUMENT;
    write32(engine, SPLATLINE_LAST_COLUMN_OFFSET, width - 1);
    write32(engine, SPLATLINE_LAST_LINE_OFFSET, height - 1);
    return take_errors(engine);
}

enum splatline_status splatline_set_material(
    struct splatline *engine, uint32_t index, const struct splatline_material *material)
{
    static const unsigned places[2][3] = {
        {SPLATLINE_MATERIAL_KD_RED_BIT, SPLATLINE_MATERIAL_KD_GREEN_BIT,
         SPLATLINE_MATERIAL_KD_BLUE_BIT},
        {SPLATLINE_MATERIAL_KS_RED_BIT, SPLATLINE_MATERIAL_KS_GREEN_BIT,
         SPLATLINE_MATERIAL_KS_BLUE_BIT},
    };
    static const unsigned widths[2][3] = {
        {SPLATLINE_MATERIAL_KD_RED_WIDTH, SPLATLINE_MATERIAL_KD_GREEN_WIDTH,
         SPLATLINE_MATERIAL_KD_BLUE_WIDTH},
        {SPLATLINE_MATERIAL_KS_RED_WIDTH, SPLATLINE_MATERIAL_KS_GREEN_WIDTH,
         SPLATLINE_MATERIAL_KS_BLUE_WIDTH},
    };
    uint64_t limbs[(SPLATLINE_MATERIAL_WORDS + 1) / 2 + 1] = {0};
    unsigned kind, channel, word;

    if (index >= SPLATLINE_MATERIAL_ENTRIES)
        return SPLATLINE_BAD_ARGUMENT;
    for (kind = 0; kind < 2; kind++) {
        const uint32_t *values = kind ? material->specular : material->diffuse;

        for (channel = 0; channel < 3; channel++) {
            if (values[channel] >> widths[kind][channel] != 0)
                return SPLATLINE_BAD_ARGUMENT;
            splatline_bits_put(limbs, places[kind][channel], widths[kind][channel], values[channel]);
        }
    }
    for (word = 0; word < SPLATLINE_MATERIAL_WORDS; word++)
        write32(
            engine, SPLATLINE_MATERIAL_OFFSET + index * SPLATLINE_MATERIAL_STRIDE + 4 * word,
            (uint32_t)(limbs[word / 2] >> (word % 2 * 32) & UINT32_MAX));
    return take_errors(engine);
}

enum splatline_status splatline_set_ambient(struct splatline *engine, const uint32_t ambient[3])
{
    if (ambient[0] > SPLATLINE_AMBIENT_RED_VALUE_MASK
        || ambient[1] > SPLATLINE_AMBIENT_GREEN_VALUE_MASK
        || ambient[2] > SPLATLINE_AMBIENT_BLUE_VALUE_MASK)
        return SPLATLINE_BAD_ARGUMENT;
    write32(engine, SPLATLINE_AMBIENT_RED_OFFSET, ambient[0]);
    write32(engine, SPLATLINE_AMBIENT_GREEN_OFFSET, ambient[1]);
    write32(engine, SPLATLINE_AMBIENT_BLUE_OFFSET, ambient[2]);
    return take_errors(engine);
}

void splatline_abort(struct splatline *engine)
{
    control(engine, SPLATLINE_CONTROL_ABORT_MASK);
}

void splatline_resync(struct splatline *engine)
{
    control(engine, SPLATLINE_CONTROL_RESYNC_MASK);
}

/* Whether a packet of the raster has whole beats, and its last one is the end beat. Of a packet
 * that is longer than the room its end is unknown. */
static int is_whole(const uint64_t *beats, size_t room, size_t limbs)
{
    if (limbs == 0 || limbs % SPLATLINE_BEAT_LIMBS != 0)
        return 0;
    return limbs > room * SPLATLINE_BEAT_LIMBS
        || SPLATLINE_BEAT_GET(END, beats + (limbs - SPLATLINE_BEAT_LIMBS), 0) != 0;
}

/* Starts both packets and waits for the picture. */
static int exchange(
    struct splatline *engine, const uint64_t *codewords, size_t word_count, const uint64_t *initial,
    size_t initial_count, uint64_t *beats, size_t room, size_t *limbs)
{
    const struct splatline_bus *bus = engine->bus;

    if (initial != NULL
        && bus->send(
               bus->context, SPLATLINE_STREAM_INITIAL, initial,
               initial_count * SPLATLINE_BEAT_LIMBS)
            != 0)
        return 1;
    if (bus->send(
            bus->context, SPLATLINE_STREAM_CODEWORDS, codewords,
            word_count * SPLATLINE_CODEWORD_LIMBS)
        != 0)
        return 1;
    if (bus->receive(bus->context, beats, room * SPLATLINE_BEAT_LIMBS, limbs) != 0)
        return 1;
    return !is_whole(beats, room, *limbs);
}

enum splatline_status splatline_draw(
    struct splatline *engine, const uint64_t *codewords, size_t word_count, const uint64_t *initial,
    size_t initial_count, uint64_t *beats, size_t beat_room, size_t *beat_count)
{
    const struct splatline_bus *bus = engine->bus;
    enum splatline_status status;
    size_t limbs = 0;

    *beat_count = 0;
    if (word_count == 0 || beat_room == 0 || (initial != NULL && initial_count == 0))
        return SPLATLINE_BAD_ARGUMENT;
    write32(engine, SPLATLINE_IRQ_STATUS_OFFSET, SPLATLINE_IRQ_STATUS_FRAME_DONE_MASK);
    write32(engine, SPLATLINE_START_OFFSET, SPLATLINE_PUT(START_LOAD, initial != NULL ? 1u : 0u));
    status = take_errors(engine);
    if (status != SPLATLINE_OK)
        return status;
    if (exchange(
            engine, codewords, word_count, initial, initial_count, beats, beat_room, &limbs)
        != 0) {
        splatline_abort(engine);
        (void)bus->receive(bus->context, beats, beat_room * SPLATLINE_BEAT_LIMBS, &limbs);
        (void)take_errors(engine);
        return SPLATLINE_STREAM_FAILED;
    }
    *beat_count = limbs / SPLATLINE_BEAT_LIMBS;
    status = take_errors(engine);
    if (*beat_count > beat_room) {
        *beat_count = beat_room;
        return SPLATLINE_NO_ROOM;
    }
    return status;
}

void splatline_read_counters(struct splatline *engine, struct splatline_counters *counters)
{
    counters->frames = read32(engine, SPLATLINE_FRAMES_OFFSET);
    counters->elements = read32(engine, SPLATLINE_ELEMENTS_OFFSET);
    counters->cycles = read32(engine, SPLATLINE_CYCLES_OFFSET);
    counters->input_stalls = read32(engine, SPLATLINE_INPUT_STALLS_OFFSET);
    counters->output_stalls = read32(engine, SPLATLINE_OUTPUT_STALLS_OFFSET);
    counters->words = read32(engine, SPLATLINE_WORDS_OFFSET);
}

void splatline_clear_counters(struct splatline *engine)
{
    control(engine, SPLATLINE_CONTROL_CLEAR_MASK);
}

/* A channel of a few bits as 8: its bits repeated, so that the largest value becomes 255. */
static uint32_t widen(uint32_t value)
{
    const unsigned bits = SPLATLINE_BEAT_COLOUR_WIDTH / 3;
    uint32_t wide = value << (8 - bits);
    unsigned known;

    for (known = bits; known < 8; known *= 2)
        wide |= wide >> known;
    return wide;
}

void splatline_expand(
    const uint64_t *beats, size_t beat_count, uint32_t width, uint32_t height, uint32_t background,
    uint32_t *pixels, size_t stride)
{
    uint32_t line, column;
    size_t beat;

    for (line = 0; line < height; line++)
        for (column = 0; column < width; column++)
            pixels[line * stride + column] = background;
    for (beat = 0; beat < beat_count; beat++, beats += SPLATLINE_BEAT_LIMBS) {
        unsigned place;

        if (SPLATLINE_BEAT_GET(END, beats, 0) != 0)
            return;
        line = (uint32_t)SPLATLINE_BEAT_GET(LINE, beats, 0);
        column = (uint32_t)SPLATLINE_BEAT_GET(WORD, beats, 0) * SPLATLINE_BEAT_PIXELS;
        for (place = 0; place < SPLATLINE_BEAT_PIXELS; place++, column++) {
            const uint32_t colour = (uint32_t)SPLATLINE_BEAT_GET(COLOUR, beats, place);

            if (line >= height || column >= width
                || SPLATLINE_BEAT_GET(DEPTH, beats, place) == SPLATLINE_BACKGROUND_DEPTH)
                continue;
            pixels[line * stride + column] = widen(SPLATLINE_COLOUR_RED(colour))
                | widen(SPLATLINE_COLOUR_GREEN(colour)) << 8
                | widen(SPLATLINE_COLOUR_BLUE(colour)) << 16;
        }
    }
}
