/* Embree's oriented discs, ray cast: the peer of `splatline bench host`. Called by embree.py.

   A frame is a primary ray through the middle of each pixel, in packets of 4 x 4 that are marked as
   coherent. Threads take tiles of 16 x 16 pixels in turn. */

#include <embree3/rtcore.h>
#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#ifdef __SSE3__
#include <pmmintrin.h>
#endif

enum { SIDE = 4, LANES = SIDE * SIDE, TILE = 16, MOST_THREADS = 256 };

typedef struct {
    RTCDevice device;
    RTCScene scene;
    const float *normals;   /* x, y, z of each point */
    const uint8_t *colours; /* r, g, b of each point */
} Discs;

typedef struct {
    const Discs *discs;
    const float *camera; /* eye; axes right, down, forward; focal, middle x, middle y, near */
    const float *light;  /* unit vector */
    int width, height, tiles;
    float *depth;    /* along the view; infinite where nothing is hit */
    uint8_t *colour; /* r, g, b */
    atomic_int next;
} Frame;

/* Builds the scene; the arrays stay with the caller and must outlive it. NULL if Embree fails. */
Discs *discs_build(const float *points, const float *normals, const uint8_t *colours,
                   unsigned count, int threads)
{
    char options[64];
    snprintf(options, sizeof options, "threads=%d", threads);
    Discs *discs = calloc(1, sizeof *discs);
    if (!discs)
        return NULL;
    discs->device = rtcNewDevice(options);
    if (!discs->device) {
        free(discs);
        return NULL;
    }
    RTCGeometry geometry = rtcNewGeometry(discs->device, RTC_GEOMETRY_TYPE_ORIENTED_DISC_POINT);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, points, 0,
                               4 * sizeof(float), count);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_NORMAL, 0, RTC_FORMAT_FLOAT3, normals, 0,
                               3 * sizeof(float), count);
    rtcCommitGeometry(geometry);
    discs->scene = rtcNewScene(discs->device);
    rtcSetSceneBuildQuality(discs->scene, RTC_BUILD_QUALITY_HIGH);
    rtcAttachGeometry(discs->scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(discs->scene);
    discs->normals = normals;
    discs->colours = colours;
    return discs;
}

/* Returns Embree's last error: 0 if there is none. */
int discs_error(const Discs *discs) { return (int)rtcGetDeviceError(discs->device); }

void discs_free(Discs *discs)
{
    rtcReleaseScene(discs->scene);
    rtcReleaseDevice(discs->device);
    free(discs);
}

/* Casts a packet of rays, its first at a column and line, and shades its pixels. */
static void draw_packet(Frame *frame, int column, int line)
{
    const float *eye = frame->camera, *right = eye + 3, *down = eye + 6, *forward = eye + 9;
    const float focal = eye[12], middle_x = eye[13], middle_y = eye[14], near = eye[15];
    _Alignas(64) struct RTCRayHit16 packet;
    _Alignas(64) int valid[LANES];
    for (int lane = 0; lane < LANES; lane++) {
        const int i = column + lane % SIDE, j = line + lane / SIDE;
        const float x = ((float)i + 0.5f - middle_x) / focal;
        const float y = ((float)j + 0.5f - middle_y) / focal;
        valid[lane] = i < frame->width && j < frame->height ? -1 : 0;
        packet.ray.org_x[lane] = eye[0];
        packet.ray.org_y[lane] = eye[1];
        packet.ray.org_z[lane] = eye[2];
        /* One unit along the view, so that the distance along the ray is the depth. */
        packet.ray.dir_x[lane] = x * right[0] + y * down[0] + forward[0];
        packet.ray.dir_y[lane] = x * right[1] + y * down[1] + forward[1];
        packet.ray.dir_z[lane] = x * right[2] + y * down[2] + forward[2];
        packet.ray.tnear[lane] = near;
        packet.ray.tfar[lane] = INFINITY;
        packet.ray.time[lane] = 0.0f;
        packet.ray.mask[lane] = ~0u;
        packet.ray.id[lane] = 0;
        packet.ray.flags[lane] = 0;
        packet.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
        packet.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
    }
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcIntersect16(valid, frame->discs->scene, &context, &packet);
    for (int lane = 0; lane < LANES; lane++) {
        if (!valid[lane])
            continue;
        const size_t pixel = (size_t)(line + lane / SIDE) * frame->width + column + lane % SIDE;
        uint8_t *to = frame->colour + 3 * pixel;
        if (packet.hit.geomID[lane] == RTC_INVALID_GEOMETRY_ID) {
            frame->depth[pixel] = INFINITY;
            to[0] = to[1] = to[2] = 255;
            continue;
        }
        const size_t point = packet.hit.primID[lane];
        const float *normal = frame->discs->normals + 3 * point;
        const uint8_t *colour = frame->discs->colours + 3 * point;
        const float *light = frame->light;
        const float lit = fabsf(normal[0] * light[0] + normal[1] * light[1] + normal[2] * light[2]);
        frame->depth[pixel] = packet.ray.tfar[lane];
        for (int channel = 0; channel < 3; channel++)
            to[channel] = (uint8_t)(lit * (float)colour[channel]);
    }
}

static void *draw_tiles(void *argument)
{
    Frame *frame = argument;
    const int across = (frame->width + TILE - 1) / TILE;
#ifdef __SSE3__ /* as Embree's manual advises; the caller's mode is put back */
    const unsigned mode = _mm_getcsr();
    _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
    _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
#endif
    int tile;
    while ((tile = atomic_fetch_add(&frame->next, 1)) < frame->tiles) {
        const int left = tile % across * TILE, top = tile / across * TILE;
        for (int line = top; line < top + TILE && line < frame->height; line += SIDE)
            for (int column = left; column < left + TILE && column < frame->width; column += SIDE)
                draw_packet(frame, column, line);
    }
#ifdef __SSE3__
    _mm_setcsr(mode);
#endif
    return NULL;
}

/* Draws a frame on as many threads as told. Returns 0, or 1 if a thread cannot be started. */
int discs_draw(const Discs *discs, const float *camera, const float *light, int width, int height,
               int threads, float *depth, uint8_t *colour)
{
    Frame frame = {discs, camera, light, width, height, 0, depth, colour, 0};
    pthread_t others[MOST_THREADS];
    int started = 0, failed = 0;
    frame.tiles = ((width + TILE - 1) / TILE) * ((height + TILE - 1) / TILE);
    while (started < threads - 1 && started < MOST_THREADS && !failed)
        if (pthread_create(&others[started], NULL, draw_tiles, &frame))
            failed = 1;
        else
            started++;
    draw_tiles(&frame);
    for (int i = 0; i < started; i++)
        pthread_join(others[i], NULL);
    return failed;
}
