#include "osc_dispatcher.h"
#include "device_io.h"

#include <stdio.h>
#include <string.h>

/* ---- sources ---- */

/* A sequence that is lower by less than this is a late datagram; by more, the sender has
 * restarted. */
enum { LATE_MAX = 1000, GAP_MAX = 1000000 };

static void forget(osc_source *source)
{
    source->has_table = false;
    source->started = false;
    clock_map_reset(&source->clock);
}

/* Returns true if this peer may send the source. A new peer restarts the source. */
static bool source_admits(osc_source *source, const udp_peer *peer, int64_t now_ns)
{
    bool is_new = !udp_owner_is(&source->owner, peer);
    if (!udp_owner_admits(&source->owner, peer, now_ns))
        return false;
    if (is_new)
        forget(source);
    source->heard_ns = now_ns;
    return true;
}

static void source_take_table(osc_source *source, const osc_table *table)
{
    if (source->has_table && source->table.version == table->version &&
        osc_table_has(&source->table, table->channel, table->count))
        return;
    source->started = false;
    source->has_table = true;
    osc_table_copy(&source->table, table);
}

/* The delay at the sender is known exactly; only the delay of the network is mapped. */
static int64_t measured_ns(osc_source *source, const osc_event *event, int64_t arrival_ns)
{
    int64_t sent_ns = clock_map_to_host(&source->clock, event->sent_ns, arrival_ns);
    int64_t time_ns = sent_ns - (event->sent_ns - event->time_ns);
    if (source->started && time_ns < source->time_ns)
        time_ns = source->time_ns;
    return time_ns;
}

typedef enum source_news {
    SOURCE_NEXT = 0, /* a newer sample */
    SOURCE_LATE,     /* older than the newest one */
    SOURCE_DOUBLE,   /* the newest one again */
    SOURCE_UNTOLD,   /* its channels are not known yet */
    SOURCE_MISSHAPEN /* the number of values differs from the channels */
} source_news;

/* Classifies a sample by its sequence. out_step: increase of the sequence (1: no loss);
 * out_time_ns: time of the measurement, our clock. Both for SOURCE_NEXT; for SOURCE_DOUBLE only
 * out_time_ns. */
static source_news source_take_sample(osc_source *source, const osc_event *event,
                                      int64_t arrival_ns, uint32_t *out_step, int64_t *out_time_ns)
{
    if (!source->has_table || source->table.version != event->version)
        return SOURCE_UNTOLD;
    if (source->table.count != event->count)
        return SOURCE_MISSHAPEN;
    uint32_t ahead = event->sequence - source->sequence, behind = 0u - ahead;
    *out_step = 1;
    *out_time_ns = source->time_ns;
    if (source->started && ahead == 0)
        return SOURCE_DOUBLE;
    if (source->started && behind <= LATE_MAX)
        return SOURCE_LATE;
    if (source->started && ahead <= GAP_MAX)
        *out_step = ahead;
    source->time_ns = *out_time_ns = measured_ns(source, event, arrival_ns);
    source->sequence = event->sequence;
    source->started = true;
    return SOURCE_NEXT;
}

/* Handles a sender's end message. */
static void source_end(osc_source *source)
{
    udp_owner_release(&source->owner);
    forget(source);
}

static const float angle_max_rad = 6.2831855f, distance_max_mm = 100000;

/* ---- channels of simple messages, with the names of the log ---- */

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
        add_channel(table, device_sensor_name[i], "rad", MRT_CH_ANGLE + i, side, -angle_max_rad,
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

void osc_listener_reset(osc_listener *self)
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
        if (self->item[self->first].step > 0) /* a release does not count as a loss */
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

/* Returns the owner that decides about this message; NULL: the message is not used. */
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

/* ---- messages to a listener ---- */

/* Call once per event, then listener_end_packet. Returns false if another sender has this data. */
static bool listener_take(osc_listener *self, const osc_event *event, const udp_peer *peer,
                          int64_t now_ns)
{
    if (self->is_forwarded)
        return true;
    udp_owner *owner = owner_of(self, event);
    if (owner && !udp_owner_admits_single(owner, peer, now_ns))
        return false;
    /* Any message of the pedals' sender shows that it is running. */
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

static void listener_end_packet(osc_listener *self, int64_t now_ns)
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

static void listener_take_table(osc_listener *self, const osc_source *source)
{
    if (self->table.count == 0)
        osc_table_copy(&self->table, &source->table);
    self->has_other_channels =
        !osc_table_has(&self->table, source->table.channel, source->table.count);
    snprintf(self->bound, sizeof self->bound, "%s", source->name);
    hear(self, source->heard_ns);
}

static void listener_take_sign_of_life(osc_listener *self, int64_t now_ns)
{
    hear(self, now_ns);
    self->pedal_heard_ns = now_ns;
}

static void listener_take_sample(osc_listener *self, const osc_event *event, uint32_t step,
                                 int64_t time_ns, int64_t now_ns)
{
    if (self->table.count != event->count || self->has_other_channels)
        return;
    osc_item item = {.time_ns = time_ns, .step = step};
    memcpy(item.value, event->value, event->count * sizeof *event->value);
    push(self, &item);
    self->has_ended = false;
    listener_take_sign_of_life(self, now_ns);
}

static void listener_take_end(osc_listener *self, int64_t now_ns)
{
    push(self, &(osc_item){.time_ns = now_ns, .step = 0});
    self->has_ended = true;
}

/* ---- the dispatcher: faults ---- */

/* Time after which a silent source loses its slot. */
static const int64_t alive_ns = 1000000000;

static void printable(char *out, size_t capacity, const char *text)
{
    size_t i = 0;
    for (; i + 1 < capacity && text[i] != '\0'; ++i)
        out[i] = text[i] >= 0x20 && text[i] < 0x7f ? text[i] : '?';
    out[i] = '\0';
}

/* Counts the fault; logs the first of each kind. */
static void complain(osc_dispatcher *self, osc_fault fault, const char *address,
                     const char *expected)
{
    if (fault == OSC_FAULT_NONE || self->fault_count[fault]++ > 0)
        return;
    char peer[UDP_PEER_TEXT], what[64], text[512];
    udp_peer_text(self->peer, peer, sizeof peer);
    printable(what, sizeof what, address);
    snprintf(text, sizeof text, "%s from %s: %.200s; such messages are dropped and counted", what,
             peer, expected);
    self->host->log(self->host, fault == OSC_FAULT_ADDRESS ? MRT_LOG_INFO : MRT_LOG_WARNING, text);
}

static void complain_of_packet(osc_dispatcher *self, osc_fault fault)
{
    if (fault == OSC_FAULT_PACKET)
        complain(self, fault, "a datagram", "not OSC: check which program sends to this port");
    else
        complain(self, fault, "a packet",
                 "more than 64 KiB, 512 messages, 256 arguments or 4 nested bundles");
}

static void complain_of_sender(osc_dispatcher *self, const char *what, const udp_owner *owner)
{
    char first[UDP_PEER_TEXT], text[160];
    udp_peer_text(&owner->peer, first, sizeof first);
    snprintf(text, sizeof text,
             "%s already sends this and is used until it is silent for 1 s: stop one of the two",
             first);
    complain(self, OSC_FAULT_SENDER, what, text);
}

/* ---- the dispatcher: sources ---- */

static osc_source *find_source(osc_dispatcher *self, const char *name)
{
    for (int i = 0; i < OSC_SOURCES_MAX; ++i)
        if (strcmp(self->source[i].name, name) == 0)
            return &self->source[i];
    return NULL;
}

static bool is_alive(const osc_source *source, int64_t now_ns)
{
    return source->name[0] != '\0' && source->owner.known && now_ns - source->heard_ns <= alive_ns;
}

static bool is_listened_to(const osc_dispatcher *self, const osc_source *source)
{
    if (source->name[0] == '\0')
        return false; /* a free slot */
    for (const osc_listener *l = self->listeners; l; l = l->next)
        if (l->is_forwarded && strcmp(l->bound, source->name) == 0)
            return true;
    return false;
}

/* Returns the source's slot, or a free one, or one of a silent source without a listener. NULL:
 * none. */
static osc_source *slot_for_source(osc_dispatcher *self, const char *name)
{
    osc_source *found = find_source(self, name);
    if (found)
        return found;
    for (int i = 0; i < OSC_SOURCES_MAX && !found; ++i)
        if (!is_alive(&self->source[i], self->now_ns) && !is_listened_to(self, &self->source[i]))
            found = &self->source[i];
    if (!found)
        return NULL;
    memset(found, 0, sizeof *found);
    snprintf(found->name, sizeof found->name, "%s", name);
    return found;
}

static bool admits(osc_dispatcher *self, osc_source *source)
{
    if (source_admits(source, self->peer, self->now_ns))
        return true;
    complain_of_sender(self, source->name, &source->owner);
    return false;
}

/* A listener to simple messages that has not received any follows the source instead. Its channels
 * change, so the input is opened again. */
static void adopt_source(osc_dispatcher *self, const osc_source *source)
{
    for (osc_listener *l = self->listeners; l; l = l->next)
        if (!l->is_forwarded && !l->has_heard && l->content == OSC_CONTENT_PEDALS) {
            l->is_forwarded = l->is_adopted = l->has_other_channels = true;
            snprintf(l->wanted, sizeof l->wanted, "%s", source->name);
            snprintf(l->bound, sizeof l->bound, "%s", source->name);
            return;
        }
}

/* Returns whether a listener of this source follows it, or waits for it. */
static bool is_wanted(const osc_dispatcher *self, const osc_source *source)
{
    for (const osc_listener *l = self->listeners; l; l = l->next)
        if (osc_listener_wants(l, source->name))
            return true;
    return false;
}

static void take_channels(osc_dispatcher *self)
{
    osc_source *source = slot_for_source(self, self->event.source);
    if (!source) {
        complain(self, OSC_FAULT_SOURCES, self->event.source,
                 "a port can have 16 sources: use another port");
        return;
    }
    if (!admits(self, source))
        return;
    source_take_table(source, &self->event.table);
    if (!is_wanted(self, source))
        adopt_source(self, source);
    for (osc_listener *l = self->listeners; l; l = l->next)
        if (osc_listener_wants(l, source->name))
            listener_take_table(l, source);
}

/* A listener without any sample also accepts a repeated one. */
static void deliver_sample(osc_dispatcher *self, const osc_source *source, source_news news,
                           uint32_t step, int64_t time_ns)
{
    for (osc_listener *l = self->listeners; l; l = l->next) {
        if (!l->is_forwarded || strcmp(l->bound, source->name) != 0)
            continue;
        if (news == SOURCE_NEXT || (news == SOURCE_DOUBLE && !l->has_sample))
            listener_take_sample(l, &self->event, step, time_ns, self->now_ns);
        else
            listener_take_sign_of_life(l, self->now_ns);
    }
}

static void take_sample(osc_dispatcher *self)
{
    osc_source *source = find_source(self, self->event.source);
    if (!source) {
        self->untold_count += 1;
        return;
    }
    if (!admits(self, source))
        return;
    uint32_t step = 1;
    int64_t time_ns = 0;
    source_news news = source_take_sample(source, &self->event, self->now_ns, &step, &time_ns);
    if (news == SOURCE_MISSHAPEN)
        complain(self, OSC_FAULT_TYPES, source->name, "expected as many values as channels");
    self->late_count += news == SOURCE_LATE;
    self->double_count += news == SOURCE_DOUBLE;
    self->untold_count += news == SOURCE_UNTOLD;
    if (news != SOURCE_MISSHAPEN && news != SOURCE_UNTOLD)
        deliver_sample(self, source, news, step, time_ns);
}

static void take_end(osc_dispatcher *self)
{
    osc_source *source = find_source(self, self->event.source);
    if (!source || !udp_owner_is(&source->owner, self->peer))
        return;
    source_end(source);
    for (osc_listener *l = self->listeners; l; l = l->next)
        if (l->is_forwarded && strcmp(l->bound, source->name) == 0)
            listener_take_end(l, self->now_ns);
}

/* ---- packets ---- */

static void deliver_to_hands(osc_dispatcher *self, const char *address)
{
    for (osc_listener *l = self->listeners; l; l = l->next) {
        if (listener_take(l, &self->event, self->peer, self->now_ns))
            continue;
        const udp_owner *owner = self->event.kind == OSC_EVENT_PEDAL   ? &l->pedal_owner
                                 : self->event.kind == OSC_EVENT_WRIST ? &l->wrist_owner
                                                                       : &l->angle_owner;
        complain_of_sender(self, address, owner);
    }
}

static void take_message(void *context, const osc_message *message)
{
    osc_dispatcher *self = context;
    osc_fault fault = osc_event_read(&self->event, message);
    if (fault != OSC_FAULT_NONE)
        complain(self, fault, message->address, self->event.expected);
    else if (self->event.kind == OSC_EVENT_CHANNELS)
        take_channels(self);
    else if (self->event.kind == OSC_EVENT_SAMPLE)
        take_sample(self);
    else if (self->event.kind == OSC_EVENT_END)
        take_end(self);
    else if (self->event.kind != OSC_EVENT_NONE)
        deliver_to_hands(self, message->address);
}

void osc_dispatcher_process(osc_dispatcher *self, void *bytes, size_t size, const udp_peer *peer,
                            int64_t now_ns, const mrt_host *host)
{
    self->peer = peer;
    self->now_ns = now_ns;
    self->host = host;
    osc_fault fault = osc_wire_read(bytes, size, take_message, self);
    if (fault != OSC_FAULT_NONE)
        complain_of_packet(self, fault);
    for (osc_listener *l = self->listeners; l; l = l->next)
        listener_end_packet(l, now_ns);
}

/* ---- listeners ---- */

void osc_dispatcher_start(osc_dispatcher *self)
{
    memset(self, 0, sizeof *self);
}

void osc_dispatcher_join(osc_dispatcher *self, osc_listener *listener, int64_t now_ns)
{
    listener->next = self->listeners;
    self->listeners = listener;
    for (int i = 0; i < OSC_SOURCES_MAX; ++i) {
        const osc_source *source = &self->source[i];
        if (is_alive(source, now_ns) && source->has_table &&
            osc_listener_wants(listener, source->name)) {
            listener_take_table(listener, source);
            return;
        }
    }
}

void osc_dispatcher_leave(osc_dispatcher *self, osc_listener *listener)
{
    for (osc_listener **at = &self->listeners; *at; at = &(*at)->next)
        if (*at == listener) {
            *at = listener->next;
            listener->next = NULL;
            return;
        }
}

void osc_dispatcher_name_sources(const osc_dispatcher *self, int64_t now_ns, char *out,
                                 size_t capacity)
{
    size_t used = 0;
    out[0] = '\0';
    for (int i = 0; i < OSC_SOURCES_MAX && used < capacity; ++i)
        if (is_alive(&self->source[i], now_ns))
            used += (size_t)snprintf(out + used, capacity - used, "%s\"%s\"", used ? ", " : "",
                                     self->source[i].name);
}
