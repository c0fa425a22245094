#include "check/child/fixture.h"

#include "base/clock.h"
#include "check/child/trap.h"
#include "hand/hand.h"
#include "hand/sensor.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

/* ---- random numbers ---- */

/* splitmix64 (S. Vigna). */
static uint64_t random_next(uint64_t *state)
{
    *state += UINT64_C(0x9e3779b97f4a7c15);
    uint64_t z = *state;
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return z ^ (z >> 31);
}

/* [0, 1) */
static double random_unit(uint64_t *state)
{
    return (double)(random_next(state) >> 11) * 0x1p-53;
}

static double random_between(uint64_t *state, double low, double high)
{
    return low + (high - low) * random_unit(state);
}

uint32_t random_below(uint64_t *state, uint32_t count)
{
    return (uint32_t)(random_next(state) >> 32) % count;
}

static bool random_one_in(uint64_t *state, uint32_t count)
{
    return random_below(state, count) == 0;
}

void random_bytes(uint64_t *state, void *out, size_t size)
{
    unsigned char *bytes = out;
    for (size_t i = 0; i < size; ++i)
        bytes[i] = (unsigned char)(random_next(state) >> 56);
}

/* ---- the host ---- */

static const int64_t overshoot_ns = 3700000;

static void host_log(const mrt_host *plugin, int32_t level, const char *text)
{
    host *self = plugin->data;
    if (level < MRT_LOG_WARNING || !text)
        return;
    uint32_t kinds = trap_set(0);
    self->error_count += 1;
    (void)snprintf(self->last_log, sizeof self->last_log, "%s", text);
    (void)trap_set(kinds);
}

int64_t host_now_ns(const host *self)
{
    return self->clock == HOST_REAL || self->clock == HOST_STOPPING ? clock_now_ns() : self->now_ns;
}

static int64_t plugin_now_ns(const mrt_host *plugin)
{
    trap_note(TRAP_HOST, "host->now_ns");
    uint32_t kinds = trap_set(0);
    int64_t now_ns = host_now_ns(plugin->data);
    (void)trap_set(kinds);
    return now_ns;
}

static int64_t plugin_wait_until_ns(const mrt_host *plugin, int64_t time_ns)
{
    host *self = plugin->data;
    trap_note(TRAP_HOST, "host->wait_until_ns");
    uint32_t kinds = trap_set(0);
    self->wait_count += 1;
    if (time_ns > self->latest_ask_ns)
        self->latest_ask_ns = time_ns;
    if (self->clock == HOST_REAL)
        clock_sleep_until_ns(time_ns);
    if (self->clock == HOST_JUMPING && time_ns > self->now_ns)
        self->now_ns = time_ns;
    if (self->clock == HOST_LATE && time_ns > self->now_ns)
        self->now_ns = time_ns > INT64_MAX - overshoot_ns ? time_ns : time_ns + overshoot_ns;
    int64_t now_ns = host_now_ns(self);
    (void)trap_set(kinds);
    return now_ns;
}

static void plugin_request_restart(const mrt_host *plugin)
{
    (void)plugin;
}

/* Reads them like the stage (services.h, which is in a higher layer). */
static void read_landmarks(const mrt_host *plugin, const mrt_landmarks *seen,
                           mrt_hand_reading *reading)
{
    static hand_skeleton *skeleton[2];
    (void)plugin;
    trap_note(TRAP_HOST, "landmark reader");
    uint32_t kinds = trap_set(0);
    reading->confidence = 0.0f;
    hand_reading now = {.confidence = 0.0};
    if (seen->side <= MRT_RIGHT && !skeleton[seen->side])
        skeleton[seen->side] = hand_skeleton_create(seen->side, HAND_LENGTH_MM);
    if (seen->side <= MRT_RIGHT && skeleton[seen->side]) {
        hand_landmarks points = {.doubtful = seen->doubtful};
        memcpy(points.at, seen->at, sizeof points.at);
        memcpy(now.angle_rad, reading->angle, sizeof now.angle_rad);
        hand_read(skeleton[seen->side], &points, &now);
    }
    if (now.confidence > 0.0) {
        memcpy(reading->angle, now.angle_rad, sizeof reading->angle);
        reading->size = (float)now.size;
        reading->confidence = (float)now.confidence;
    }
    (void)trap_set(kinds);
}

static const void *plugin_service(const mrt_host *plugin, const char *id)
{
    static const mrt_landmark_reader landmarks = {read_landmarks};
    (void)plugin;
    trap_note(TRAP_HOST, "host->service");
    return strcmp(id, MRT_LANDMARKS) == 0 ? &landmarks : NULL;
}

void host_init(host *out, host_clock clock, int64_t start_ns)
{
    *out = (host){.clock = clock, .now_ns = start_ns};
    out->plugin = (mrt_host){
        out, host_log, plugin_now_ns, plugin_wait_until_ns, plugin_request_restart, plugin_service};
}

const char *host_words(const host *self, char out[300])
{
    (void)snprintf(out, 300, "%s%s", self->last_log[0] ? ": " : "", self->last_log);
    return out;
}

/* ---- faces ---- */

enum { CONTACTS_MAX = 64, POSES = 3, USUAL_CONTACTS = 27, USUAL_DOFS = 13 };

/* Similar to the puppet: 270 mm high. */
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
    mrt_rig_pose pose[POSES];
    mrt_vec3 pose_pull[POSES][CONTACTS_MAX];
    float pose_dof[POSES][MRT_MAX_DOFS];
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
        out->contact[0] = usual_contact[14]; /* one corner of the mouth, without the other */
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

/* ---- poses of a rig ---- */

static const char *const pose_names[POSES] = {"viseme_aa", "eyeBlinkLeft", "joy"};
static const uint32_t pose_parts[POSES] = {MRT_POSE_MOUTH, MRT_POSE_UPPER, MRT_POSE_WHOLE};

/* A pose of one half leaves the other half at rest. */
static bool has_part(uint32_t part, bool is_upper)
{
    return part == MRT_POSE_WHOLE || (part == MRT_POSE_UPPER) == is_upper;
}

static void shape_poses(face_room *out)
{
    const mrt_face *face = &out->face;
    const float scale = (face->high.y - face->low.y) / 270.0f;
    const float middle = 0.5f * (face->high.y + face->low.y);
    for (uint32_t p = 0; p < POSES; ++p) {
        for (uint32_t i = 0; i < face->contact_count; ++i) {
            const float way_mm = scale * (1.0f + (float)((i + p) % 4));
            if (has_part(pose_parts[p], out->contact[i].rest.y > middle))
                out->pose_pull[p][i] = (mrt_vec3){0.5f * way_mm, -way_mm, way_mm};
        }
        for (uint32_t i = 0; i < face->dof_count; ++i) {
            const mrt_dof *d = &out->dof[i];
            const bool is_upper = d->name[0] == 'e' || d->name[0] == 'l';
            if (has_part(pose_parts[p], is_upper))
                out->pose_dof[p][i] = (0.3f + 0.1f * (float)p) * d->max;
        }
        out->pose[p] =
            (mrt_rig_pose){pose_names[p], out->pose_pull[p], out->pose_dof[p], pose_parts[p]};
    }
}

face_poses faces_poses(const mrt_face *face)
{
    for (int kind = 0; kind < FACE_KINDS; ++kind)
        if (face == &rooms[kind].face && kind != FACE_BARE)
            return (face_poses){rooms[kind].pose, POSES};
    return (face_poses){NULL, 0};
}

bool posed_pages_create(posed_pages *out, const mrt_face *face, uint32_t count, float scale)
{
    const face_poses from = faces_poses(face);
    const size_t page = (size_t)sysconf(_SC_PAGESIZE);
    const size_t wanted = POSES * (sizeof(mrt_rig_pose) + sizeof(mrt_vec3[CONTACTS_MAX]) +
                                   sizeof(float[MRT_MAX_DOFS]) + 32);
    *out = (posed_pages){.size = (wanted + page - 1) / page * page};
    out->pages = mmap(NULL, out->size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (out->pages == MAP_FAILED)
        return false;
    mrt_rig_pose *pose = out->pages;
    mrt_vec3 *pull = (mrt_vec3 *)(pose + POSES);
    float *dof = (float *)(pull + (size_t)POSES * CONTACTS_MAX);
    char(*name)[32] = (char(*)[32])(dof + (size_t)POSES * MRT_MAX_DOFS);
    for (uint32_t p = 0; p < count && p < from.count; ++p) {
        const mrt_rig_pose *of = &from.pose[p];
        for (uint32_t i = 0; i < face->contact_count; ++i)
            pull[i] =
                (mrt_vec3){scale * of->pulls[i].x, scale * of->pulls[i].y, scale * of->pulls[i].z};
        for (uint32_t i = 0; i < face->dof_count; ++i)
            dof[i] = scale * of->dofs[i];
        (void)snprintf(*name, sizeof *name, "%s", of->name);
        pose[p] = (mrt_rig_pose){*name, pull, dof, of->part};
        pull += CONTACTS_MAX;
        dof += MRT_MAX_DOFS;
        name += 1;
    }
    out->poses = (face_poses){pose, count < from.count ? count : from.count};
    if (out->poses.count == 0)
        posed_pages_forbid(out);
    return true;
}

void posed_pages_forbid(posed_pages *self)
{
    if (mprotect(self->pages, self->size, PROT_NONE) != 0)
        abort(); /* otherwise the test would detect nothing */
}

const mrt_face *faces_of(face_kind kind)
{
    face_room *room = &rooms[kind];
    if (!room->face.contacts) {
        shape(room, kind);
        room->face.contacts = room->contact;
        room->face.dofs = room->dof;
        shape_poses(room);
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

/* ---- hands ---- */

static const int64_t frame_ns = 6666667; /* 150 Hz */
static const double rad_per_deg = 0.017453292519943295;
static const double wrist_range_mm = 120.0;

static hand_skeleton *skeleton[2];

bool stream_begin(stream *out, stream_kind kind, uint64_t seed, const mrt_plugin_type *type)
{
    for (uint32_t side = 0; side < 2; ++side)
        if (!skeleton[side])
            skeleton[side] = hand_skeleton_create(side, HAND_LENGTH_MM);
    memset(out, 0, sizeof *out);
    out->kind = kind;
    out->random = seed;
    out->type = type;
    out->time_ns = 1000000000;
    out->next_press = 40;
    for (uint32_t i = 0; i < type->param_count && i < STREAM_PARAMS_MAX; ++i)
        out->param[i] = type->params[i].initial;
    for (int side = 0; side < 2; ++side) {
        stream_hand *hand = &out->hand[side];
        hand->present = kind != STREAM_ABSENT && (kind != STREAM_ONE_HAND || side == MRT_RIGHT);
        hand->speed = 0.02;
        for (int i = 0; i < MRT_ANGLES; ++i)
            hand->angle[i] = hand->goal[i] = (double)sensor_table[i].neutral_rad;
    }
    return skeleton[0] && skeleton[1];
}

/* ---- parameters ---- */

static bool is_trigger(const mrt_param *p)
{
    return p->flags & MRT_PARAM_TRIGGER;
}

static double any_value(stream *self, const mrt_param *p)
{
    double value = random_between(&self->random, p->min, p->max);
    if (random_one_in(&self->random, 5))
        value = random_one_in(&self->random, 2) ? p->min : p->max;
    if (p->flags & MRT_PARAM_STEPPED)
        value = fmin(p->max, p->min + floor(random_between(&self->random, 0, p->max - p->min + 1)));
    return value;
}

void stream_shuffle_choices(stream *self)
{
    for (uint32_t i = 0; i < self->type->param_count; ++i) {
        const mrt_param *p = &self->type->params[i];
        if ((p->flags & MRT_PARAM_STEPPED) && !is_trigger(p))
            self->param[i] = any_value(self, p);
    }
}

static void let_triggers_go(stream *self)
{
    for (uint32_t i = 0; i < self->type->param_count; ++i)
        if (is_trigger(&self->type->params[i]))
            self->param[i] = self->type->params[i].initial;
}

static void change_one_param(stream *self)
{
    if (self->type->param_count == 0)
        return;
    uint32_t i = random_below(&self->random, self->type->param_count);
    const mrt_param *p = &self->type->params[i];
    self->param[i] = is_trigger(p) ? p->max : any_value(self, p);
}

static void press_one_trigger(stream *self)
{
    uint32_t count = self->type->param_count;
    uint32_t first = count ? random_below(&self->random, count) : 0;
    for (uint32_t k = 0; k < count; ++k) {
        uint32_t i = (first + k) % count;
        if (!is_trigger(&self->type->params[i]))
            continue;
        self->param[i] = self->type->params[i].max;
        return;
    }
}

static void move_one_pedal(stream *self)
{
    uint32_t i = random_below(&self->random, MRT_MAX_PEDALS);
    self->pedal[i] = self->pedal[i] > 0.5f ? 0.0f : 1.0f;
}

/* ---- hands ---- */

/* Also beyond its clinical range, because calibrations are not perfect. */
static double any_angle(stream *self, int sensor)
{
    double low = (double)sensor_table[sensor].low_deg * rad_per_deg;
    double high = (double)sensor_table[sensor].high_deg * rad_per_deg;
    double margin = 0.2 * (high - low);
    if (self->kind != STREAM_EXTREMES)
        return random_between(&self->random, low - margin, high + margin);
    uint32_t end = random_below(&self->random, 5);
    if (end == 4)
        return random_one_in(&self->random, 2) ? -3.1415 : 3.1415; /* limits of the filter */
    return end == 0 ? low : end == 1 ? high : end == 2 ? low - margin : high + margin;
}

static void choose_goal(stream *self, stream_hand *hand)
{
    bool is_calm = self->kind == STREAM_CALM;
    for (int i = 0; i < MRT_ANGLES; ++i)
        if (random_one_in(&self->random, 2))
            hand->goal[i] = any_angle(self, i);
    for (int i = 0; i < 3; ++i)
        hand->wrist_goal_mm[i] = random_between(&self->random, -wrist_range_mm, wrist_range_mm);
    hand->speed = is_calm ? 0.002 : random_between(&self->random, 0.005, 0.3);
    if (self->kind == STREAM_EXTREMES)
        hand->speed = 1.0;
}

static void move_hand(stream *self, stream_hand *hand)
{
    if (random_one_in(&self->random, self->kind == STREAM_EXTREMES ? 2 : 40))
        choose_goal(self, hand);
    for (int i = 0; i < MRT_ANGLES; ++i)
        hand->angle[i] += hand->speed * (hand->goal[i] - hand->angle[i]);
    for (int i = 0; i < 3; ++i)
        hand->wrist_mm[i] += hand->speed * (hand->wrist_goal_mm[i] - hand->wrist_mm[i]);
    hand->time_ns = self->time_ns;
}

static void come_and_go(stream *self)
{
    bool is_staying = self->kind == STREAM_CALM || self->kind == STREAM_ABSENT;
    if (is_staying || !random_one_in(&self->random, 150))
        return;
    uint32_t side = self->kind == STREAM_ONE_HAND ? MRT_RIGHT : random_below(&self->random, 2);
    self->hand[side].present = !self->hand[side].present;
}

static void write_hand(const stream_hand *from, int side, mrt_hand *out)
{
    if (!from->present) {
        out->present = false; /* the other values are the last known ones */
        return;
    }
    rigid wrist = rigid_identity();
    wrist.t = (vec3){from->wrist_mm[0], from->wrist_mm[1], from->wrist_mm[2]};
    out->present = true;
    out->time_ns = from->time_ns;
    for (int i = 0; i < MRT_ANGLES; ++i)
        out->angle[i] = (float)from->angle[i];
    hand_pose(skeleton[side], out->angle, &wrist, out->joint, out->palm);
}

/* ---- frames ---- */

static int64_t step_ns(stream *self)
{
    if (self->kind != STREAM_CALM && random_one_in(&self->random, 200))
        return random_one_in(&self->random, 2) ? 0 : 400000000; /* the same time twice, or a gap */
    return frame_ns + (int64_t)random_below(&self->random, 200000);
}

static void press(stream *self)
{
    let_triggers_go(self);
    if (self->kind == STREAM_RESTLESS && random_one_in(&self->random, 20))
        change_one_param(self);
    if (self->kind == STREAM_CALM && self->index < self->next_press)
        return;
    if (self->kind != STREAM_CALM && !random_one_in(&self->random, 60))
        return;
    self->next_press = self->index + 15 + random_below(&self->random, 60);
    if (random_one_in(&self->random, 2))
        press_one_trigger(self);
    else
        move_one_pedal(self);
}

/* ---- all channels ---- */

static const mrt_channel fader_channels[] = {{"fader 1", "", MRT_CH_OTHER, MRT_NO_HAND, 0, 1},
                                             {"fader 2", "", MRT_CH_OTHER, MRT_NO_HAND, 0, 1},
                                             {"pitch", "", MRT_CH_OTHER, MRT_NO_HAND, -1, 1},
                                             {"play", "", MRT_CH_BUTTON, MRT_NO_HAND, 0, 1},
                                             {"note 60", "", MRT_CH_OTHER, MRT_NO_HAND, 0, 127}};
enum { FADERS = sizeof fader_channels / sizeof *fader_channels };

static const mrt_channel *phone_channels(void)
{
    static mrt_channel out[MRT_MAX_CHANNELS];
    for (uint32_t i = 0; i < MRT_MAX_CHANNELS; ++i)
        out[i] = (mrt_channel){i == 0 ? "jawOpen" : "shape", "", MRT_CH_OTHER, MRT_NO_HAND, 0, 1};
    return out;
}

/* Faders are present from the first frame on. A phone appears later, and may exceed its ranges. */
static void move_channels(stream *self, mrt_frame *out)
{
    static const uint32_t phone_comes = 50;
    if (self->kind == STREAM_ABSENT)
        return; /* only pedals */
    if (self->index == 0)
        self->channel_random = 0x9e3779b97f4a7c15u;
    for (uint32_t i = 0; i < STREAM_INPUTS; ++i) {
        mrt_channels *in = &self->input[i];
        *in = (mrt_channels){.name = i == 0 ? "midi faders" : "phone 1",
                             .channel = i == 0 ? fader_channels : phone_channels(),
                             .value = self->channel[i],
                             .time_ns = self->time_ns,
                             .count = i == 0 ? (uint32_t)FADERS : MRT_MAX_CHANNELS};
        uint32_t c = random_below(&self->channel_random, in->count);
        double span = (double)(in->channel[c].max - in->channel[c].min);
        self->channel[i][c] =
            in->channel[c].min +
            (float)random_between(&self->channel_random, -0.1 * span * (double)i, 1.1 * span);
    }
    out->inputs = self->input;
    out->input_count = self->index < phone_comes ? 1 : STREAM_INPUTS;
}

void stream_next(stream *self, mrt_frame *out)
{
    int64_t passed_ns = self->index == 0 ? 0 : step_ns(self);
    self->time_ns += passed_ns;
    press(self);
    come_and_go(self);
    out->time_ns = self->time_ns;
    out->dt_s = fmin((double)passed_ns / 1e9, 0.1);
    for (int side = 0; side < 2; ++side) {
        move_hand(self, &self->hand[side]);
        write_hand(&self->hand[side], side, &out->hand[side]);
    }
    memcpy(out->pedal, self->pedal, sizeof out->pedal);
    out->near = self->index > 3 && !random_one_in(&self->random, 8);
    out->params = self->param;
    out->inputs = NULL;
    out->input_count = 0;
    move_channels(self, out);
    self->index += 1;
}

const char *stream_name(stream_kind kind)
{
    static const char *const names[] = {
        [STREAM_WALK] = "a random walk",
        [STREAM_RESTLESS] = "a random walk with changing parameters",
        [STREAM_EXTREMES] = "hands at the ends of their ranges",
        [STREAM_CALM] = "slow hands that take hold and let go",
        [STREAM_ABSENT] = "no hand at all",
        [STREAM_ONE_HAND] = "one hand that comes and goes",
    };
    return names[kind];
}
