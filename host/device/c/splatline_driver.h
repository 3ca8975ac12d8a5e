/* A driver of a Splatline engine on AXI, in freestanding C99.
 *
 * It needs no library and no heap. It reaches the engine through four functions of yours. The
 * header splatline.h is made for the engine's preset: splatline registers --c-driver FOLDER.
 *
 *     struct splatline engine;
 *     enum splatline_status status = splatline_open(&engine, &bus);
 *     splatline_set_size(&engine, 512, 512);
 *     splatline_set_material(&engine, 0, &material);
 *     splatline_draw(&engine, words, word_count, NULL, 0, beats, beat_room, &beat_count);
 *     splatline_expand(beats, beat_count, 512, 512, 0x1f1a17, pixels, 512);
 *
 * SPDX-License-Identifier: BSD-2-Clause */
#ifndef SPLATLINE_DRIVER_H
#define SPLATLINE_DRIVER_H

#include <stddef.h>
#include <stdint.h>

#include "splatline.h"

enum splatline_status {
    SPLATLINE_OK = 0,
    SPLATLINE_NO_ENGINE,     /* the register ID does not say SPLT */
    SPLATLINE_OTHER_VERSION, /* the registers are of another version than splatline.h */
    SPLATLINE_OTHER_ENGINE,  /* the engine has another configuration than splatline.h */
    SPLATLINE_BAD_ARGUMENT,  /* a value is out of its range; nothing was written */
    SPLATLINE_REFUSED,       /* the engine refused it or saw bad input: engine->errors says what */
    SPLATLINE_STREAM_FAILED, /* a function of the bus failed, or the picture came late */
    SPLATLINE_NO_ROOM        /* the picture has more beats than there is room for */
};

enum splatline_stream {
    SPLATLINE_STREAM_CODEWORDS, /* s_axis_codewords */
    SPLATLINE_STREAM_INITIAL    /* s_axis_initial */
};

/* How the driver reaches an engine. Offsets are in bytes, from the engine's first register. */
struct splatline_bus {
    void *context; /* is passed to each function */
    uint32_t (*read32)(void *context, uint32_t offset);
    void (*write32)(void *context, uint32_t offset, uint32_t value); /* complete on return */
    /* Starts to send a packet, TLAST with its last word; returns 0, or anything else if it fails.
     * The limbs must be left alone until the picture has been received. */
    int (*send)(void *context, enum splatline_stream stream, const uint64_t *limbs, size_t count);
    /* Waits for a packet of the raster, up to TLAST; stores at most `room` limbs, and how many there
     * were. Returns 0, or anything else if the packet does not end in time. */
    int (*receive)(void *context, uint64_t *limbs, size_t room, size_t *count);
};

/* An engine. Only `errors` is for the caller: bits of the register ERROR, the last time it was not
 * zero: SPLATLINE_GET(ERROR_LINE_PAST, engine.errors). */
struct splatline {
    const struct splatline_bus *bus;
    uint32_t errors;
};

/* Coefficients kD and kS of red, green and blue, as fixed-point numbers of the engine. */
struct splatline_material {
    uint32_t diffuse[3];
    uint32_t specular[3];
};

/* Counters since the last splatline_clear_counters; each wraps at 2^32. */
struct splatline_counters {
    uint32_t frames, elements, cycles, input_stalls, output_stalls, words;
};

/* Looks for the engine, compares it with splatline.h, and sets CONTROL.QUIET: a refused access is
 * then a bit of ERROR and no fault of the processor. */
enum splatline_status splatline_open(struct splatline *engine, const struct splatline_bus *bus);

/* Size of the image in pixels, for the frames that follow. */
enum splatline_status splatline_set_size(struct splatline *engine, uint32_t width, uint32_t height);

/* One entry of the material table. */
enum splatline_status splatline_set_material(
    struct splatline *engine, uint32_t index, const struct splatline_material *material);

/* I0 of red, green and blue, each with its fraction bits. */
enum splatline_status splatline_set_ambient(struct splatline *engine, const uint32_t ambient[3]);

/* Draws a frame.
 *
 * codewords: `word_count` code words of SPLATLINE_CODEWORD_LIMBS limbs each, the end word last.
 * initial: beats of the raster to start from, the end beat last; NULL: background.
 * beats: room for `beat_room` beats of SPLATLINE_BEAT_LIMBS limbs each. `beat_count` becomes how many
 * came, the end beat included.
 *
 * A frame that does not end in time, or whose packet has no end beat, is aborted. The engine is ready for the next frame whatever
 * is returned, but after SPLATLINE_STREAM_FAILED the DMA of the bus may have to be reset, and then
 * splatline_resync called. */
enum splatline_status splatline_draw(
    struct splatline *engine, const uint64_t *codewords, size_t word_count, const uint64_t *initial,
    size_t initial_count, uint64_t *beats, size_t beat_room, size_t *beat_count);

/* Ends the open frame; the rest of its packets is dropped, and its picture ends. */
void splatline_abort(struct splatline *engine);

/* Says that the rest of the packets will never come, as their DMA was reset. */
void splatline_resync(struct splatline *engine);

void splatline_read_counters(struct splatline *engine, struct splatline_counters *counters);
void splatline_clear_counters(struct splatline *engine);

/* Makes a picture of beats: `height` lines of `width` pixels, each line `stride` numbers after the
 * one before. A pixel is 0x00bbggrr with 8 bits a channel: byte 0 is red on a little-endian
 * machine. Beats outside the image are left out. */
void splatline_expand(
    const uint64_t *beats, size_t beat_count, uint32_t width, uint32_t height, uint32_t background,
    uint32_t *pixels, size_t stride);

#endif
