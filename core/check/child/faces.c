#include "check/child/faces.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { CONTACTS_MAX = 64, USUAL_CONTACTS = 27, USUAL_DOFS = 13 };

/* As a puppet's: 270 mm high. */
static const mrt_contact usual_contact[USUAL_CONTACTS] = {
    {"brow.inner.l", "skull", {18, 100, 70}, {0, 0, 1}},
    {"brow.inner.r", "skull", {-18, 100, 70}, {0, 0, 1}},
    {"brow.mid.l", "skull", {38, 108, 66}, {0, 0, 1}},
    {"brow.mid.r", "skull", {-38, 108, 66}, {0, 0, 1}},
    {"brow.outer.l", "skull", {58, 103, 54}, {0.6f, 0, 0.8f}},
    {"brow.outer.r", "skull", {-58, 103, 54}, {-0.6f, 0, 0.8f}},
    {"cheek.l", "skull", {55, 20, 60}, {0.6f, 0, 0.8f}},
    {"cheek.r", "skull", {-55, 20, 60}, {-0.6f, 0, 0.8f}},
    {"cheek.lower.l", "skull", {52, -20, 55}, {0.6f, 0, 0.8f}},
    {"cheek.lower.r", "skull", {-52, -20, 55}, {-0.6f, 0, 0.8f}},
    {"nasolabial.l", "skull", {28, 0, 75}, {0, 0, 1}},
    {"nasolabial.r", "skull", {-28, 0, 75}, {0, 0, 1}},
    {"nose.wing.l", "skull", {14, 15, 88}, {0, 0, 1}},
    {"nose.wing.r", "skull", {-14, 15, 88}, {0, 0, 1}},
    {"mouth.corner.l", "skull", {34, -38, 72}, {0, 0, 1}},
    {"mouth.corner.r", "skull", {-34, -38, 72}, {0, 0, 1}},
    {"lip.upper.side.l", "skull", {18, -33, 82}, {0, 0, 1}},
    {"lip.upper.side.r", "skull", {-18, -33, 82}, {0, 0, 1}},
    {"lip.lower.side.l", "jaw", {18, -45, 80}, {0, 0, 1}},
    {"lip.lower.side.r", "jaw", {-18, -45, 80}, {0, 0, 1}},
    {"jaw.angle.l", "jaw", {64, -45, 10}, {1, 0, 0}},
    {"jaw.angle.r", "jaw", {-64, -45, 10}, {-1, 0, 0}},
    {"lip.upper.mid", "skull", {0, -31, 86}, {0, 0, 1}},
    {"lip.lower.mid", "jaw", {0, -46, 84}, {0, 0, 1}},
    {"chin", "jaw", {0, -85, 74}, {0, 0, 1}},
    {"nose.tip", "skull", {0, 22, 100}, {0, 0, 1}},
    {"forehead.mid", "skull", {0, 135, 64}, {0, 0, 1}},
};
static const mrt_dof usual_dof[USUAL_DOFS] = {
    {"skull.turn", "rad", -0.87f, 0.87f},
    {"skull.nod", "rad", -0.43f, 0.52f},
    {"jaw.open", "rad", 0, 0.56f},
    {"jaw.lateral", "mm", -10, 10},
    {"jaw.forward", "mm", 0, 8},
    {"eye.l.yaw", "rad", -0.6f, 0.6f},
    {"eye.r.yaw", "rad", -0.6f, 0.6f},
    {"eye.l.pitch", "rad", -0.43f, 0.43f},
    {"eye.r.pitch", "rad", -0.43f, 0.43f},
    {"lid_upper.l.close", "rad", -0.2f, 0.87f},
    {"lid_upper.r.close", "rad", -0.2f, 0.87f},
    {"lid_lower.l.close", "rad", -0.14f, 0.35f},
    {"lid_lower.r.close", "rad", -0.14f, 0.35f},
};
static const mrt_vec3 usual_low = {-85, -120, -90}, usual_high = {85, 150, 100};

typedef struct face_room {
    mrt_face face;
    mrt_contact contact[CONTACTS_MAX];
    mrt_dof dof[MRT_MAX_DOFS];
    char contact_name[CONTACTS_MAX][24], dof_name[MRT_MAX_DOFS][24];
} face_room;

static face_room rooms[FACE_KINDS];

static void copy_usual(face_room *out)
{
    memcpy(out->contact, usual_contact, sizeof usual_contact);
    memcpy(out->dof, usual_dof, sizeof usual_dof);
    out->face = (mrt_face){.contact_count = USUAL_CONTACTS,
                           .dof_count = USUAL_DOFS,
                           .low = usual_low,
                           .high = usual_high};
}

static mrt_vec3 placed(mrt_vec3 p, mrt_vec3 scale, mrt_vec3 shift)
{
    return (mrt_vec3){p.x * scale.x + shift.x, p.y * scale.y + shift.y, p.z * scale.z + shift.z};
}

static void place_all(face_room *out, mrt_vec3 scale, mrt_vec3 shift)
{
    for (uint32_t i = 0; i < out->face.contact_count; ++i)
        out->contact[i].rest = placed(out->contact[i].rest, scale, shift);
    out->face.low = placed(out->face.low, scale, shift);
    out->face.high = placed(out->face.high, scale, shift);
}

static void place_scaled(face_room *out, float scale)
{
    place_all(out, (mrt_vec3){scale, scale, scale}, (mrt_vec3){0, 0, 0});
}

static void fill_up(face_room *out)
{
    for (uint32_t i = USUAL_CONTACTS; i < CONTACTS_MAX; ++i) {
        (void)snprintf(out->contact_name[i], sizeof out->contact_name[i], "place.%u", i);
        uint32_t column = i % 8, row = i / 8;
        mrt_vec3 rest = {(float)column * 10 - 35, (float)row * 20 - 90, 60};
        out->contact[i] = (mrt_contact){out->contact_name[i], "skull", rest, {0, 0, 1}};
    }
    for (uint32_t i = USUAL_DOFS; i < MRT_MAX_DOFS; ++i) {
        (void)snprintf(out->dof_name[i], sizeof out->dof_name[i], "extra.%u", i);
        out->dof[i] = (mrt_dof){out->dof_name[i], "rad", -0.5f, 0.5f};
    }
    out->face.contact_count = CONTACTS_MAX;
    out->face.dof_count = MRT_MAX_DOFS;
}

static void drop_jaw(face_room *out)
{
    uint32_t contacts = 0, dofs = 0;
    for (uint32_t i = 0; i < out->face.contact_count; ++i)
        if (strcmp(out->contact[i].bone, "jaw") != 0)
            out->contact[contacts++] = out->contact[i];
    for (uint32_t i = 0; i < out->face.dof_count; ++i)
        if (strncmp(out->dof[i].name, "jaw.", 4) != 0)
            out->dof[dofs++] = out->dof[i];
    out->face.contact_count = contacts;
    out->face.dof_count = dofs;
}

static void shape(face_room *out, face_kind kind)
{
    copy_usual(out);
    if (kind == FACE_BARE)
        out->face.contact_count = out->face.dof_count = 0;
    if (kind == FACE_ONE) {
        out->contact[0] = usual_contact[14]; /* a corner of the mouth, without its twin */
        out->dof[0] = usual_dof[2];
        out->face.contact_count = out->face.dof_count = 1;
    }
    if (kind == FACE_FULL)
        fill_up(out);
    if (kind == FACE_NO_JAW)
        drop_jaw(out);
    if (kind == FACE_FLAT)
        place_all(out, (mrt_vec3){1, 1, 0}, (mrt_vec3){0, 0, 0});
    if (kind == FACE_TINY)
        place_scaled(out, 0.5f / 270.0f);
    if (kind == FACE_HUGE)
        place_scaled(out, 1e5f / 270.0f);
    if (kind == FACE_AWAY)
        place_all(out, (mrt_vec3){1, 1, 1}, (mrt_vec3){2000, -500, 100});
}

const mrt_face *faces_of(face_kind kind)
{
    face_room *room = &rooms[kind];
    if (!room->face.contacts) {
        shape(room, kind);
        room->face.contacts = room->contact;
        room->face.dofs = room->dof;
    }
    return &room->face;
}

const char *faces_name(face_kind kind)
{
    static const char *const names[FACE_KINDS] = {
        [FACE_USUAL] = "the usual face",
        [FACE_BARE] = "a face without contacts",
        [FACE_ONE] = "a face of one contact",
        [FACE_FULL] = "a face of 64 contacts",
        [FACE_NO_JAW] = "a face without a jaw",
        [FACE_FLAT] = "a flat face",
        [FACE_TINY] = "a face half a millimetre high",
        [FACE_HUGE] = "a face a hundred metres high",
        [FACE_AWAY] = "a face two metres from the origin",
    };
    return names[kind];
}

double faces_reach_mm(const mrt_face *face, double out_centre[3])
{
    const float low[3] = {face->low.x, face->low.y, face->low.z};
    const float high[3] = {face->high.x, face->high.y, face->high.z};
    double size = 1.0;
    for (int i = 0; i < 3; ++i) {
        out_centre[i] = 0.5 * ((double)low[i] + (double)high[i]);
        size = fmax(size, (double)high[i] - (double)low[i]);
    }
    return 10.0 * size;
}
