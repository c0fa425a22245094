#include "osc_dispatcher.h"

#include <stdio.h>
#include <string.h>

/* As long as a source counts as there, and keeps its place, though it is silent. */
static const int64_t alive_ns = 1000000000;

/* ---- faults ---- */

static void printable(char *out, size_t capacity, const char *text)
{
    size_t i = 0;
    for (; i + 1 < capacity && text[i] != '\0'; ++i)
        out[i] = text[i] >= 0x20 && text[i] < 0x7f ? text[i] : '?';
    out[i] = '\0';
}

/* Counts the fault; says the first of each kind. */
static void complain(osc_dispatcher *self, osc_fault fault, const char *address,
                     const char *expected)
{
    if (fault == OSC_FAULT_NONE || self->fault_count[fault]++ > 0)
        return;
    char peer[UDP_PEER_TEXT], what[64], text[512];
    udp_peer_text(self->peer, peer, sizeof peer);
    printable(what, sizeof what, address);
    snprintf(text, sizeof text, "%s from %s: %.200s; such are dropped and counted", what, peer,
             expected);
    self->host->log(self->host, fault == OSC_FAULT_ADDRESS ? MRT_LOG_INFO : MRT_LOG_WARNING, text);
}

static void complain_of_packet(osc_dispatcher *self, osc_fault fault)
{
    if (fault == OSC_FAULT_PACKET)
        complain(self, fault, "a datagram", "it is no OSC: what else sends to this port?");
    else
        complain(self, fault, "a packet",
                 "it holds more than 64 KiB, 512 messages, 256 arguments "
                 "or 4 bundles in each other");
}

static void complain_of_sender(osc_dispatcher *self, const char *what, const udp_owner *owner)
{
    char first[UDP_PEER_TEXT], text[160];
    udp_peer_text(&owner->peer, first, sizeof first);
    snprintf(text, sizeof text,
             "%s sends this already and counts until it is silent for 1 s: "
             "stop one of the two",
             first);
    complain(self, OSC_FAULT_SENDER, what, text);
}

/* ---- sources ---- */

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
        return false; /* a free place */
    for (const osc_listener *l = self->listeners; l; l = l->next)
        if (l->is_forwarded && strcmp(l->bound, source->name) == 0)
            return true;
    return false;
}

/* The source's place, or one for it: free, or of one that is silent and that nobody listens to.
 * NULL: there is none. */
static osc_source *place_of_source(osc_dispatcher *self, const char *name)
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
    if (osc_source_admits(source, self->peer, self->now_ns))
        return true;
    complain_of_sender(self, source->name, &source->owner);
    return false;
}

static void take_channels(osc_dispatcher *self)
{
    osc_source *source = place_of_source(self, self->event.source);
    if (!source) {
        complain(self, OSC_FAULT_SOURCES, self->event.source,
                 "there is room for 16 sources at one port: use another port");
        return;
    }
    if (!admits(self, source))
        return;
    osc_source_take_table(source, &self->event.table);
    for (osc_listener *l = self->listeners; l; l = l->next)
        if (osc_listener_wants(l, source->name))
            osc_listener_take_table(l, source);
}

/* Who has heard nothing yet takes also a sample that others have had. */
static void tell_sample(osc_dispatcher *self, const osc_source *source, osc_source_news news,
                        uint32_t step, int64_t time_ns)
{
    for (osc_listener *l = self->listeners; l; l = l->next) {
        if (!l->is_forwarded || strcmp(l->bound, source->name) != 0)
            continue;
        if (news == OSC_SOURCE_NEXT || (news == OSC_SOURCE_DOUBLE && !l->has_sample))
            osc_listener_take_sample(l, &self->event, step, time_ns, self->now_ns);
        else
            osc_listener_take_sign_of_life(l, self->now_ns);
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
    osc_source_news news =
        osc_source_take_sample(source, &self->event, self->now_ns, &step, &time_ns);
    if (news == OSC_SOURCE_MISSHAPEN)
        complain(self, OSC_FAULT_TYPES, source->name, "expected as many values as channels");
    self->late_count += news == OSC_SOURCE_LATE;
    self->double_count += news == OSC_SOURCE_DOUBLE;
    self->untold_count += news == OSC_SOURCE_UNTOLD;
    if (news != OSC_SOURCE_MISSHAPEN && news != OSC_SOURCE_UNTOLD)
        tell_sample(self, source, news, step, time_ns);
}

static void take_end(osc_dispatcher *self)
{
    osc_source *source = find_source(self, self->event.source);
    if (!source || !udp_owner_is(&source->owner, self->peer))
        return;
    osc_source_end(source);
    for (osc_listener *l = self->listeners; l; l = l->next)
        if (l->is_forwarded && strcmp(l->bound, source->name) == 0)
            osc_listener_take_end(l, self->now_ns);
}

/* ---- packets ---- */

static void tell_hands(osc_dispatcher *self, const char *address)
{
    for (osc_listener *l = self->listeners; l; l = l->next) {
        if (osc_listener_take(l, &self->event, self->peer, self->now_ns))
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
        tell_hands(self, message->address);
}

void osc_dispatcher_take(osc_dispatcher *self, void *bytes, size_t size, const udp_peer *peer,
                         int64_t now_ns, const mrt_host *host)
{
    self->peer = peer;
    self->now_ns = now_ns;
    self->host = host;
    osc_fault fault = osc_wire_read(bytes, size, take_message, self);
    if (fault != OSC_FAULT_NONE)
        complain_of_packet(self, fault);
    for (osc_listener *l = self->listeners; l; l = l->next)
        osc_listener_end_packet(l, now_ns);
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
            osc_listener_take_table(listener, source);
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
