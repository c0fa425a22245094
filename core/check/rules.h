/* check/rules.h - the rules for plugins: each has an id that never changes, the types that it
 * applies to, and the text of plugin.h. Constants. [any] */
#ifndef MAROTTE_CHECK_RULES_H
#define MAROTTE_CHECK_RULES_H
#include <stdbool.h>
#include <stdint.h>

/* Types that a rule applies to, by their interfaces. */
enum {
    CONCERNS_LIBRARY = 1, /* the file, with any types */
    CONCERNS_TYPE = 2,    /* every type */
    CONCERNS_PARAMS = 4,
    CONCERNS_MAPPING = 8,
    CONCERNS_INPUT = 16,
    CONCERNS_RECORDED = 32, /* inputs with MRT_INPUT_RECORDED */
    CONCERNS_OUTPUT = 64,
    CONCERNS_STATE = 128,
    CONCERNS_RESUME = 256,
    CONCERNS_DEVICES = 512,
    CONCERNS_FACE_OUTPUT = 1024,
    CONCERNS_TAUGHT_POSES = 2048,
    CONCERNS_RIG_POSES = 4096
};

/* RULE(name, id, concerns, what plugin.h says) */
#define CHECK_RULES(RULE)                                                                          \
    RULE(LIBRARY_LOAD, "library.load", CONCERNS_LIBRARY, "A plugin is a shared library.")          \
    RULE(LIBRARY_SYMBOL, "library.symbol", CONCERNS_LIBRARY,                                       \
         "It exports one symbol, marotte_plugins: a NULL-ended array of types.")                   \
    RULE(LIBRARY_ABI, "library.abi", CONCERNS_LIBRARY,                                             \
         "abi: MRT_ABI; types with another abi are rejected.")                                     \
    RULE(LIBRARY_IDS, "library.ids", CONCERNS_LIBRARY,                                             \
         "The id of a type never changes, and is unique.")                                         \
    RULE(TYPE_WORDS, "type.words", CONCERNS_TYPE,                                                  \
         "A type has an id, a name, a version and a text about it.")                               \
    RULE(TYPE_ID, "type.id", CONCERNS_TYPE, "id \"org.marotte.anchored\": it never changes.")      \
    RULE(TYPE_FUNCTIONS, "type.functions", CONCERNS_TYPE,                                          \
         "A type has create and destroy, and all functions of each interface.")                    \
    RULE(TYPE_INTERFACES, "type.interfaces", CONCERNS_TYPE,                                        \
         "Interfaces have ids \"domain.name/revision\" and end with id NULL; one is an input, "    \
         "a mapping, an output or a face output.")                                                 \
    RULE(TYPE_CONST, "type.const", CONCERNS_TYPE, "A type is const data.")                         \
    RULE(PARAM_WORDS, "param.words", CONCERNS_PARAMS,                                              \
         "A parameter has a name, a group, a unit, and one sentence of help.")                     \
    RULE(PARAM_RANGE, "param.range", CONCERNS_PARAMS,                                              \
         "min, max, initial: finite, min < max, min <= initial <= max.")                           \
    RULE(PARAM_IDS, "param.ids", CONCERNS_PARAMS,                                                  \
         "The id of a parameter never changes and is never reused: presets and takes store it.")   \
    RULE(PARAM_KEYS, "param.keys", CONCERNS_PARAMS,                                                \
         "Group and name identify a parameter; \"group.name=value\" sets it.")                     \
    RULE(PARAM_FLAGS, "param.flags", CONCERNS_PARAMS,                                              \
         "MRT_PARAM_*: stepped parameters are integers; a trigger is 0, and 1 for one call.")      \
    RULE(PARAM_LABELS, "param.labels", CONCERNS_PARAMS,                                            \
         "labels: for stepped parameters, a name per value from min up, NULL-ended; or NULL.")     \
    RULE(LIFE_CREATE, "life.create", CONCERNS_TYPE,                                                \
         "create() returns an instance; NULL: failed, with a logged reason.")                      \
    RULE(LIFE_DESTROY_NULL, "life.destroy_null", CONCERNS_TYPE, "destroy() accepts NULL.")         \
    RULE(LIFE_GROWTH, "life.growth", CONCERNS_TYPE,                                                \
         "destroy() releases everything of create(): memory, files, threads.")                     \
    RULE(LIFE_THREADS, "life.threads", CONCERNS_MAPPING,                                           \
         "[main] is not always the same thread: a plugin stores nothing per thread.")              \
    RULE(RUN_CRASH, "run.crash", CONCERNS_TYPE, "No valid argument crashes a plugin.")             \
    RULE(RUN_HANG, "run.hang", CONCERNS_TYPE,                                                      \
         "[frame]: no unbounded loop; [main]: a few milliseconds; [input]: until its deadline.")   \
    RULE(RUN_EXIT, "run.exit", CONCERNS_TYPE, "A plugin does not end the process.")                \
    RULE(RUN_EXPLAINED, "run.explained", CONCERNS_TYPE,                                            \
         "< 0: an error, already explained through host->log.")                                    \
    RULE(MAPPING_ACTIVATE, "mapping.activate", CONCERNS_MAPPING,                                   \
         "activate() accepts a face with the usual contacts and degrees of freedom.")              \
    RULE(MAPPING_FACES, "mapping.faces", CONCERNS_MAPPING,                                         \
         "A face is valid from activate until deactivate: any face, and nothing of the last one.") \
    RULE(MAPPING_GROWTH, "mapping.growth", CONCERNS_MAPPING,                                       \
         "deactivate() releases everything of activate(): memory, files, threads.")                \
    RULE(MAPPING_RESULT, "mapping.result", CONCERNS_MAPPING,                                       \
         "process() returns MRT_OK or MRT_HOLD for a valid frame.")                                \
    RULE(MAPPING_MODE, "mapping.mode", CONCERNS_MAPPING,                                           \
         "mode: MRT_IDLE, MRT_ANCHORED or MRT_UNANCHORED.")                                        \
    RULE(MAPPING_COUNT, "mapping.count", CONCERNS_MAPPING,                                         \
         "count: number of used vectors, at most MRT_MAX_VECTORS.")                                \
    RULE(MAPPING_FINITE, "mapping.finite", CONCERNS_MAPPING,                                       \
         "Starts and ends are places in mm; a degree of freedom is a number, or NaN: not driven.") \
    RULE(MAPPING_REACH, "mapping.reach", CONCERNS_MAPPING,                                         \
         "The host's guard: starts and ends are at most ten sizes of the face away from it.")      \
    RULE(MAPPING_RADIUS, "mapping.radius", CONCERNS_MAPPING,                                       \
         "radius_mm: a length; 0: that of the rig.")                                               \
    RULE(MAPPING_LEAK, "mapping.leak", CONCERNS_MAPPING, "leak_per_s: a rate; 0: never.")          \
    RULE(MAPPING_GATE, "mapping.gate", CONCERNS_MAPPING, "gate: 0 or 1.")                          \
    RULE(MAPPING_CONTACT, "mapping.contact", CONCERNS_MAPPING,                                     \
         "contact: 1 + index of the contact that it pulls; 0: a free point.")                      \
    RULE(MAPPING_OVERRUN, "mapping.overrun", CONCERNS_MAPPING,                                     \
         "process() fills the given pull, and writes to no memory beside it.")                     \
    RULE(MAPPING_CONST, "mapping.const", CONCERNS_MAPPING,                                         \
         "The frame, the parameters, the face and its poses are const: the host owns them.")       \
    RULE(MAPPING_HOLD, "mapping.hold", CONCERNS_MAPPING,                                           \
         "MRT_HOLD: keep the last offsets; the pull is unchanged.")                                \
    RULE(                                                                                          \
        MAPPING_ANCHOR, "mapping.anchor", CONCERNS_MAPPING,                                        \
        "anchor: changes when the starts of anchored vectors change; otherwise starts are fixed.") \
    RULE(MAPPING_JUMP, "mapping.jump", CONCERNS_MAPPING,                                           \
         "A new hold of the face begins without a jump: end == start, or where the last one "      \
         "ended.")                                                                                 \
    RULE(RIG_POSES_SET, "rig_poses.set", CONCERNS_RIG_POSES,                                       \
         "set() takes the poses of any rig; a mesh without a rig has none.")                       \
    RULE(RIG_POSES_VALID, "rig_poses.valid", CONCERNS_RIG_POSES,                                   \
         "The poses are valid until deactivate; after that they are not read.")                    \
    RULE(RIG_POSES_CHANGE, "rig_poses.change", CONCERNS_RIG_POSES,                                 \
         "set() is called before each activate: nothing of the previous poses is left.")           \
    RULE(FRAME_ALLOCATION, "frame.allocation", CONCERNS_MAPPING, "[frame]: no allocation.")        \
    RULE(FRAME_LOCK, "frame.lock", CONCERNS_MAPPING, "[frame]: no lock.")                          \
    RULE(FRAME_FILE, "frame.file", CONCERNS_MAPPING, "[frame]: no I/O.")                           \
    RULE(FRAME_NETWORK, "frame.network", CONCERNS_MAPPING, "[frame]: no I/O, no socket.")          \
    RULE(FRAME_CLOCK, "frame.clock", CONCERNS_MAPPING,                                             \
         "[frame]: no clock; the frame has the time.")                                             \
    RULE(FRAME_SLEEP, "frame.sleep", CONCERNS_MAPPING, "[frame]: no waiting.")                     \
    RULE(FRAME_PROCESS, "frame.process", CONCERNS_MAPPING,                                         \
         "[frame]: no start of a process, thread or library.")                                     \
    RULE(FRAME_HOST, "frame.host", CONCERNS_MAPPING,                                               \
         "now_ns and wait_until_ns are [main] [input], service is [main]: none is [frame].")       \
    RULE(FRAME_DEADLINE, "frame.deadline", CONCERNS_MAPPING,                                       \
         "[frame] is real-time: p99 of process() is below 0.2 ms of the thread's own CPU clock.")  \
    RULE(REPLAY_SAME, "replay.same", CONCERNS_MAPPING,                                             \
         "The output of a mapping depends only on its state and arguments: same take, same bits.") \
    RULE(REPLAY_PROCESS, "replay.process", CONCERNS_MAPPING,                                       \
         "Same take, same bits: also in another process, at other addresses.")                     \
    RULE(REPLAY_INSTANCES, "replay.instances", CONCERNS_MAPPING,                                   \
         "Same take, same bits: independent of other instances.")                                  \
    RULE(REPLAY_RESET, "replay.reset", CONCERNS_MAPPING,                                           \
         "reset(): forget the past: filters, anchors, clutch.")                                    \
    RULE(STATE_SIZE, "state.size", CONCERNS_STATE,                                                 \
         "save() returns its size and writes at most `capacity` bytes.")                           \
    RULE(STATE_ROUND, "state.round", CONCERNS_STATE,                                               \
         "load() accepts the bytes of save(); saving again gives the same bytes.")                 \
    RULE(STATE_REFUSES, "state.refuses", CONCERNS_STATE,                                           \
         "load() rejects invalid bytes: MRT_ERR_FORMAT.")                                          \
    RULE(STATE_ALL_OR_NONE, "state.all_or_none", CONCERNS_STATE,                                   \
         "load(): all or none: rejected bytes change nothing.")                                    \
    RULE(STATE_POSES, "state.poses", CONCERNS_TAUGHT_POSES,                                        \
         "pose(): finite angles or MRT_END for bytes of save(); other bytes: MRT_ERR_FORMAT.")     \
    RULE(RESUME_SIZE, "resume.size", CONCERNS_RESUME,                                              \
         "save() writes at most `capacity` bytes (out may be NULL); returns its size.")            \
    RULE(RESUME_SAME, "resume.same", CONCERNS_RESUME,                                              \
         "After load() the same frames give the same pulls, bit for bit, as after save().")        \
    RULE(RESUME_SILENT, "resume.silent", CONCERNS_RESUME, "save() changes nothing.")               \
    RULE(RESUME_REFUSES, "resume.refuses", CONCERNS_RESUME,                                        \
         "load() rejects damaged bytes, and bytes of other plugins.")                              \
    RULE(RESUME_ALL_OR_NONE, "resume.all_or_none", CONCERNS_RESUME,                                \
         "load(): all or none: rejected bytes change nothing.")                                    \
    RULE(INPUT_ABSENT, "input.absent", CONCERNS_INPUT,                                             \
         "open() of a missing device returns an error and explains it in words.")                  \
    RULE(INPUT_CHANNELS, "input.channels", CONCERNS_INPUT,                                         \
         "1 to MRT_MAX_CHANNELS channels with name, unit, a known meaning and a range; until "     \
         "close they stay.")                                                                       \
    RULE(INPUT_COUNT, "input.count", CONCERNS_INPUT, "count of a sample: that of channels().")     \
    RULE(INPUT_FINITE, "input.finite", CONCERNS_INPUT, "value[]: raw, finite.")                    \
    RULE(INPUT_ORDER, "input.order", CONCERNS_INPUT,                                               \
         "time_ns: never before the last sample's; sequence: +1 each time, more if some were "     \
         "lost.")                                                                                  \
    RULE(INPUT_FUTURE, "input.future", CONCERNS_INPUT, "time_ns: never in the future.")            \
    RULE(INPUT_DEADLINE, "input.deadline", CONCERNS_INPUT,                                         \
         "read() waits, but not past the deadline.")                                               \
    RULE(INPUT_TIMEOUT, "input.timeout", CONCERNS_INPUT,                                           \
         "MRT_TIMEOUT: nothing arrived before the deadline, which has passed.")                    \
    RULE(INPUT_RESULT, "input.result", CONCERNS_INPUT,                                             \
         "read() returns MRT_OK, MRT_TIMEOUT, MRT_END or an error.")                               \
    RULE(INPUT_SPIN, "input.spin", CONCERNS_INPUT, "read() waits: it does not spin.")              \
    RULE(INPUT_REOPEN, "input.reopen", CONCERNS_INPUT,                                             \
         "The host closes and opens again, with the same address: the channels are the same.")     \
    RULE(INPUT_GROWTH, "input.growth", CONCERNS_INPUT,                                             \
         "close() releases everything of open(): memory, files, threads.")                         \
    RULE(INPUT_STOP, "input.stop", CONCERNS_INPUT,                                                 \
         "If host->wait_until_ns returns early, the host is stopping: read() returns.")            \
    RULE(INPUT_RECORDED, "input.recorded", CONCERNS_RECORDED,                                      \
         "MRT_INPUT_RECORDED: read() waits with host->wait_until_ns alone: any speed, same "       \
         "samples.")                                                                               \
    RULE(DEVICES_LIST, "devices.list", CONCERNS_DEVICES,                                           \
         "list() writes up to `capacity` devices, each with address, name, state and advice.")     \
    RULE(DEVICES_CURRENT, "devices.current", CONCERNS_DEVICES,                                     \
         "current(): the open device; false: none.")                                               \
    RULE(OUTPUT_ABSENT, "output.absent", CONCERNS_OUTPUT,                                          \
         "open() of an invalid address returns an error and explains it in words.")                \
    RULE(OUTPUT_WRITE, "output.write", CONCERNS_OUTPUT,                                            \
         "write() passes a sample on; a failure of the network is not an error.")                  \
    RULE(OUTPUT_WAIT, "output.wait", CONCERNS_OUTPUT, "write() never waits.")                      \
    RULE(OUTPUT_REOPEN, "output.reopen", CONCERNS_OUTPUT,                                          \
         "close() releases everything of open(), and a later open() succeeds.")                    \
    RULE(FACE_OUTPUT_ABSENT, "face_output.absent", CONCERNS_FACE_OUTPUT,                           \
         "open() of an invalid address returns an error and explains it in words.")                \
    RULE(FACE_OUTPUT_FACES, "face_output.faces", CONCERNS_FACE_OUTPUT,                             \
         "begin() accepts any face, also without bones, contacts, shapes or weights.")             \
    RULE(FACE_OUTPUT_SEND, "face_output.send", CONCERNS_FACE_OUTPUT,                               \
         "send() returns MRT_OK or MRT_TIMEOUT; a missing receiver is not an error.")              \
    RULE(FACE_OUTPUT_TIME, "face_output.time", CONCERNS_FACE_OUTPUT,                               \
         "send() may take some milliseconds: faces that arrive meanwhile are skipped.")            \
    RULE(FACE_OUTPUT_REOPEN, "face_output.reopen", CONCERNS_FACE_OUTPUT,                           \
         "close() releases everything of open(), and a later open() succeeds.")

typedef enum check_rule {
#define CHECK_RULE_NAME(name, id, concerns, says) RULE_##name,
    CHECK_RULES(CHECK_RULE_NAME)
#undef CHECK_RULE_NAME
        RULE_COUNT
} check_rule;

const char *check_rule_id(check_rule rule);    /* "mapping.finite" */
const char *check_rule_text(check_rule rule);  /* a sentence */
uint32_t check_rule_concerns(check_rule rule); /* CONCERNS_* */
/* Returns false if no rule has that id. */
bool check_rule_find(const char *id, check_rule *out);

#endif
