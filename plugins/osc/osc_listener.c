#include "osc_listener.h"

#include <stdio.h>
#include <string.h>

static const float angle_max_rad = 6.2831855f, distance_max_mm = 100000;

/* ---- channels of simple messages, by the names of the log ---- */

static const char *const sensor_name[MRT_ANGLES] = {
    "thumb.roll", "thumb.mpj",  "thumb.ij",    "thumb.abd",  "index.mpj",  "index.pij",
    "index.dij",  "middle.mpj", "middle.pij",  "middle.dij", "middle.abd", "ring.mpj",
    "ring.pij",   "ring.dij",   "ring.abd",    "little.mpj", "little.pij", "little.dij",
    "little.abd", "palm.arch",  "wrist.pitch", "wrist.yaw"};
static const char *const wrist_name[7] = {"wrist.x",  "wrist.y",  "wrist.z", "wrist.qx",
                                          "wrist.qy", "wrist.qz", "wrist.qw"};

static void add_channel(osc_table *table, const char *name, const char *unit, uint32_t semantic,
                        uint32_t hand, float low, float high)
{
    uint32_t i = table->count++;
    static const char *const prefix[] = {"left.", "right.", ""};
    snprintf(table->name[i], OSC_NAME_LENGTH, "%s%s", prefix[hand], name);
    snprintf(table->unit[i], OSC_UNIT_LENGTH, "%s", unit);
    table->channel[i] = (mrt_channel){table->name[i], table->unit[i], semantic, hand, low, high};
}

static void describe_controls(osc_table *table)
{
    for (uint32_t i = 0; i < OSC_CONTROLS; ++i) {
        char name[16];
        if (i < OSC_CONTROLLERS)
            snprintf(name, sizeof name, "cc.%u", i);
        else
            snprintf(name, sizeof name, "key.%c", 'a' + (int)(i - OSC_CONTROLLERS));
        add_channel(table, name, "", i < OSC_CONTROLLERS ? MRT_CH_OTHER : MRT_CH_BUTTON,
                    MRT_NO_HAND, 0, 1);
    }
}

static bool is_of_hand(osc_content content)
{
    return content == OSC_CONTENT_PEDALS || content == OSC_CONTENT_WRIST;
}

static void describe(osc_table *table, uint32_t side, osc_content content)
{
    memset(table, 0, sizeof *table);
    if (content == OSC_CONTENT_CONTROLS) {
        describe_controls(table);
        return;
    }
    for (uint32_t i = 0; is_of_hand(content) && i < MRT_ANGLES; ++i)
        add_channel(table, sensor_name[i], "rad", MRT_CH_ANGLE + i, side, -angle_max_rad,
                    angle_max_rad);
    for (uint32_t i = 0; content == OSC_CONTENT_WRIST && i < 7; ++i)
        add_channel(table, wrist_name[i], i < 3 ? "mm" : "1", MRT_CH_WRIST + i, side,
                    i < 3 ? -distance_max_mm : -2, i < 3 ? distance_max_mm : 2);
    for (uint32_t i = 0; content != OSC_CONTENT_WRIST && i < MRT_MAX_PEDALS; ++i) {
        char name[16];
        snprintf(name, sizeof name, "pedal.%u", i + 1);
        add_channel(table, name, "1", MRT_CH_PEDAL + i, MRT_NO_HAND, 0, 1);
    }
}

void osc_listener_start_simple(osc_listener *self, uint32_t side, osc_content content)
{
    memset(self, 0, sizeof *self);
    self->side = side;
    self->content = content;
    self->wrist[6] = 1; /* no turn */
    describe(&self->table, side, content);
}

void osc_listener_start_forwarded(osc_listener *self, const char *wanted)
{
    memset(self, 0, sizeof *self);
    self->is_forwarded = true;
    snprintf(self->wanted, sizeof self->wanted, "%s", wanted);
}

void osc_listener_rearm(osc_listener *self)
{
    self->first = self->count = self->frame_bones = 0;
    self->has_heard = self->has_sample = false;
    self->has_ended = false;
    if (self->has_other_channels)
        self->table.count = 0;
    self->has_other_channels = false;
    clock_map_reset(&self->clock);
    osc_listener_release_pedals(self);
}

/* ---- the queue ---- */

static void push(osc_listener *self, const osc_item *item)
{
    uint32_t step = 0;
    if (self->count == OSC_QUEUE_ITEMS) {
        step = self->item[self->first].step;
        self->first = (self->first + 1) % OSC_QUEUE_ITEMS;
        self->count -= 1;
        if (self->item[self->first].step > 0) /* a release loses nothing */
            self->item[self->first].step += step;
    }
    self->item[(self->first + self->count++) % OSC_QUEUE_ITEMS] = *item;
    self->has_sample = true;
}

bool osc_listener_pop(osc_listener *self, osc_item *out)
{
    if (self->count == 0)
        return false;
    *out = self->item[self->first];
    self->first = (self->first + 1) % OSC_QUEUE_ITEMS;
    self->count -= 1;
    return true;
}

static void hear(osc_listener *self, int64_t now_ns)
{
    self->has_heard = true;
    self->heard_ns = now_ns;
}

/* ---- simple messages ---- */

static bool has_angles(const osc_listener *self, uint32_t side)
{
    return is_of_hand(self->content) && side == self->side;
}

static bool has_pedals(const osc_listener *self)
{
    return self->content == OSC_CONTENT_PEDALS || self->content == OSC_CONTENT_PEDALS_ONLY;
}

/* Whose message this must be to count; NULL: it is of no use here. */
static udp_owner *owner_of(osc_listener *self, const osc_event *event)
{
    switch (event->kind) {
    case OSC_EVENT_ANGLES:
    case OSC_EVENT_BONE:
        return has_angles(self, event->side) ? &self->angle_owner : NULL;
    case OSC_EVENT_WRIST:
        return self->content == OSC_CONTENT_WRIST && event->side == self->side ? &self->wrist_owner
                                                                               : NULL;
    case OSC_EVENT_PEDAL:
        return has_pedals(self) ? &self->pedal_owner : NULL;
    case OSC_EVENT_CONTROL:
        return self->content == OSC_CONTENT_CONTROLS ? &self->control_owner : NULL;
    default:
        return NULL;
    }
}

static void apply(osc_listener *self, const osc_event *event)
{
    size_t size = event->count * sizeof *event->value;
    if (event->kind == OSC_EVENT_ANGLES)
        memcpy(self->angle + event->first, event->value, size);
    else if (event->kind == OSC_EVENT_WRIST)
        memcpy(self->wrist, event->value, sizeof self->wrist);
    else if (event->kind == OSC_EVENT_PEDAL)
        self->pedal[event->first] = event->value[0];
    else if (event->kind == OSC_EVENT_CONTROL)
        self->control[event->first] = event->value[0];
}

static void put_values(const osc_listener *self, float *out)
{
    if (self->content == OSC_CONTENT_CONTROLS) {
        memcpy(out, self->control, sizeof self->control);
        return;
    }
    uint32_t count = 0;
    if (is_of_hand(self->content)) {
        memcpy(out, self->angle, sizeof self->angle);
        count = MRT_ANGLES;
    }
    if (has_pedals(self))
        memcpy(out + count, self->pedal, sizeof self->pedal);
    else
        memcpy(out + count, self->wrist, sizeof self->wrist);
}

static void push_values(osc_listener *self, int64_t tag_ns, int64_t now_ns)
{
    osc_item item = {.time_ns = now_ns, .step = 1};
    if (tag_ns >= -OSC_TIME_MAX_NS && tag_ns <= OSC_TIME_MAX_NS)
        item.time_ns = clock_map_to_host(&self->clock, tag_ns, now_ns);
    put_values(self, item.value);
    push(self, &item);
}

/* ---- frames of bones ---- */

static const int64_t frame_span_ns = 4000000;

static void close_frame(osc_listener *self)
{
    if (self->frame_bones == 0)
        return;
    self->frame_bones = 0;
    push_values(self, self->frame_tag_ns, self->frame_ns);
}

static void take_bone(osc_listener *self, const osc_event *event, int64_t now_ns)
{
    osc_vmc_bone bone = event->bone;
    osc_vmc_settle(&self->pose, &bone);
    const uint32_t bit = 1u << (bone.finger * 3 + bone.joint);
    if (self->frame_bones & bit)
        close_frame(self);
    if (self->frame_bones == 0)
        self->frame_due_ns = now_ns + frame_span_ns;
    self->frame_bones |= bit;
    self->frame_ns = now_ns;
    self->frame_tag_ns = event->tag_ns;
    osc_vmc_apply(&self->pose, &bone, event->value, self->angle);
}

int64_t osc_listener_frame_due_ns(const osc_listener *self)
{
    return self->frame_bones == 0 ? INT64_MAX : self->frame_due_ns;
}

void osc_listener_close_frame_if_due(osc_listener *self, int64_t now_ns)
{
    if (osc_listener_frame_due_ns(self) <= now_ns)
        close_frame(self);
}

/* ---- messages ---- */

bool osc_listener_take(osc_listener *self, const osc_event *event, const udp_peer *peer,
                       int64_t now_ns)
{
    if (self->is_forwarded)
        return true;
    udp_owner *owner = owner_of(self, event);
    if (owner && !udp_owner_admits_single(owner, peer, now_ns))
        return false;
    /* Whatever the pedals' sender says shows that it is there. */
    if (udp_owner_is(&self->pedal_owner, peer)) {
        self->pedal_heard_ns = now_ns;
        hear(self, now_ns);
    }
    if (event->kind == OSC_EVENT_FRAME && udp_owner_is(&self->angle_owner, peer))
        close_frame(self);
    if (!owner)
        return true;
    hear(self, now_ns);
    if (event->kind == OSC_EVENT_BONE) {
        take_bone(self, event, now_ns);
        return true;
    }
    apply(self, event);
    self->is_touched = true;
    self->tag_ns = event->tag_ns;
    return true;
}

void osc_listener_end_packet(osc_listener *self, int64_t now_ns)
{
    osc_listener_close_frame_if_due(self, now_ns);
    if (!self->is_touched)
        return;
    self->is_touched = false;
    push_values(self, self->tag_ns, now_ns);
}

void osc_listener_release_pedals(osc_listener *self)
{
    memset(self->pedal, 0, sizeof self->pedal);
}

/* ---- a forwarded source ---- */

bool osc_listener_wants(const osc_listener *self, const char *source)
{
    if (!self->is_forwarded)
        return false;
    if (self->bound[0] != '\0')
        return strcmp(self->bound, source) == 0;
    size_t length = strlen(self->wanted);
    return strncmp(self->wanted, source, length) == 0 &&
           (length == 0 || source[length] == '\0' || source[length] == ' ');
}

void osc_listener_take_table(osc_listener *self, const osc_source *source)
{
    if (self->table.count == 0)
        osc_table_copy(&self->table, &source->table);
    self->has_other_channels =
        !osc_table_has(&self->table, source->table.channel, source->table.count);
    snprintf(self->bound, sizeof self->bound, "%s", source->name);
    hear(self, source->heard_ns);
}

void osc_listener_take_sample(osc_listener *self, const osc_event *event, uint32_t step,
                              int64_t time_ns, int64_t now_ns)
{
    if (self->table.count != event->count || self->has_other_channels)
        return;
    osc_item item = {.time_ns = time_ns, .step = step};
    memcpy(item.value, event->value, event->count * sizeof *event->value);
    push(self, &item);
    self->has_ended = false;
    osc_listener_take_sign_of_life(self, now_ns);
}

void osc_listener_take_sign_of_life(osc_listener *self, int64_t now_ns)
{
    hear(self, now_ns);
    self->pedal_heard_ns = now_ns;
}

void osc_listener_take_end(osc_listener *self, int64_t now_ns)
{
    push(self, &(osc_item){.time_ns = now_ns, .step = 0});
    self->has_ended = true;
}
