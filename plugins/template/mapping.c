/* template_name: bending the fingers pushes the face outwards and opens its jaw. A mapping for
 * marotte: README.md explains how to build and try it, marotte/plugin.h is the whole contract. */
#include <marotte/plugin.h>

#include <stdlib.h>
#include <string.h>

enum { PUSH, EASE, PARAM_COUNT }; /* the order of the table of parameters below */

struct mrt_plugin {       /* one instance: its whole state */
    const mrt_face *face; /* from activate until deactivate */
    float bend;           /* 0 a flat hand, 1 a fist: the only state of process() */
};

static mrt_plugin *create(const mrt_host *host) /* [main] */
{
    (void)host; /* host->log reports errors to the user */
    return (mrt_plugin *)calloc(1, sizeof(mrt_plugin));
}

static void destroy(mrt_plugin *self) /* [main] */
{
    free(self);
}

static mrt_result activate(mrt_plugin *self, const mrt_face *face) /* [main] allocate here */
{
    self->face = face;
    return MRT_OK;
}

static void deactivate(mrt_plugin *self) /* [main] free here what activate allocated */
{
    self->face = NULL;
}

static void reset(mrt_plugin *self) /* [frame] forget the past: another performance begins */
{
    self->bend = 0.0f;
}

static void push(mrt_vector *vector, uint32_t contact, mrt_vec3 at, mrt_vec3 way, float mm)
{
    vector->contact = contact;
    vector->start = vector->end = at;
    vector->end.x += mm * way.x;
    vector->end.y += mm * way.y;
    vector->end.z += mm * way.z;
}

/* [frame] Once per sample: no allocation, lock, file, clock or endless loop. */
static mrt_result process(mrt_plugin *self, const mrt_frame *frame, mrt_pull *pull)
{
    const mrt_face *face = self->face;
    const mrt_hand *hand = &frame->hand[frame->hand[MRT_RIGHT].present ? MRT_RIGHT : MRT_LEFT];
    if (!hand->present)
        return MRT_HOLD; /* the face does not change */

    /* The knuckles of four fingers; 1.5 rad each is a fist. */
    const float *angle = hand->angle;
    float bend = (angle[4] + angle[7] + angle[11] + angle[15]) / 6.0f;
    if (frame->dt_s > 0.0) /* follows slowly, so that the face does not jump when a hand appears */
        self->bend +=
            (bend - self->bend) * (float)(frame->dt_s / (frame->params[EASE] + frame->dt_s));
    float height_mm = face->high.y - face->low.y;
    float mm = self->bend * height_mm * (float)(0.01 * frame->params[PUSH]);

    pull->mode = MRT_ANCHORED;
    pull->anchor = 1; /* the starts never change, so the anchor does not either */
    pull->count = 0;
    for (uint32_t i = 0; i < face->contact_count && i < MRT_MAX_VECTORS; ++i)
        push(&pull->vector[pull->count++], i + 1, face->contacts[i].rest, face->contacts[i].normal,
             mm);
    if (pull->count == 0) { /* a mesh without a rig: one free point at its front */
        mrt_vec3 front = {0.5f * (face->low.x + face->high.x), face->low.y + 0.4f * height_mm,
                          face->high.z};
        mrt_vec3 forward = {0.0f, 0.0f, 1.0f};
        push(&pull->vector[pull->count++], 0, front, forward, mm);
    }
    for (uint32_t i = 0; i < face->dof_count && i < MRT_MAX_DOFS; ++i)
        if (strcmp(face->dofs[i].name, "jaw.open") == 0)
            pull->dof[i] = 0.6f * self->bend * face->dofs[i].max;
    return MRT_OK;
}

/* ---- resume: saves the state of process(), so that a take can be played from any time ---- */

typedef struct memory {
    char tag[32];    /* rejects the bytes of other plugins */
    float bend, too; /* twice: a damaged bit makes them differ */
} memory;

static size_t save(mrt_plugin *self, void *out, size_t capacity) /* [frame] */
{
    const memory now = {"template_name/1", self->bend, self->bend};
    if (out && capacity >= sizeof now)
        memcpy(out, &now, sizeof now);
    return sizeof now;
}

static mrt_result load(mrt_plugin *self, const void *bytes, size_t size) /* [frame] all or none */
{
    memory then;
    if (size != sizeof then)
        return MRT_ERR_FORMAT;
    memcpy(&then, bytes, sizeof then);
    const memory good = {"template_name/1", then.bend, then.bend};
    if (memcmp(&then, &good, sizeof good) != 0 || !(then.bend > -10.0f && then.bend < 10.0f))
        return MRT_ERR_FORMAT; /* the last test also rejects NaN */
    self->bend = then.bend;
    return MRT_OK;
}

/* ---- what the host reads ---- */

/* clang-format off */
static const mrt_param params[PARAM_COUNT] = {
    /* id (for ever), flags, name, group, unit, help, min, max, initial, labels */
    {1, 0, "Push", "Face", "%",
     "Movement of the face for a fist, in per cent of the face's height.",
     -10, 10, 3, NULL},
    {2, 0, "Ease", "Face", "s", "Time in which the face follows the hand.", 0, 1, 0.05, NULL},
};
static const mrt_mapping mapping = {activate, deactivate, reset, process};
static const mrt_resume resume = {save, load};
static const mrt_interface interfaces[] = {
    {MRT_MAPPING, &mapping}, {MRT_RESUME, &resume}, {NULL, NULL}};
static const mrt_plugin_type type = {
    MRT_ABI, PARAM_COUNT, params, interfaces,
    "org.example.template_name", "template_name", "1.0",
    "Bending the fingers pushes the face outwards and opens its jaw.", create, destroy};
/* clang-format on */

const mrt_plugin_type *const marotte_plugins[] = {&type, NULL}; /* the only exported symbol */
