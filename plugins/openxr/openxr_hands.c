/* marotte-openxr-hands - writes the hands of the active OpenXR runtime as records to descriptor 3.
 * A separate program, because it loads the runtime and its drivers. The plugin (openxr_helper.c)
 * starts and watches it. It ends with a record of the reason, or when the reader closes the
 * pipe. */
#include "device_io.h"
#include "openxr_record.h"

#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#define XR_USE_TIMESPEC
#include <openxr/openxr.h>
#include <openxr/openxr_platform.h>

static const int64_t tick_ns = 5000000; /* headsets: 30 to 60 hands per second, others up to 120 */
static const int64_t ns_per_s = 1000000000;

typedef struct session {
    XrInstance instance;
    XrSession session;
    XrSpace space;
    XrHandTrackerEXT tracker[2];
    PFN_xrLocateHandJointsEXT locate;
    PFN_xrConvertTimespecTimeToTimeKHR from_timespec; /* NULL: this runtime cannot convert times */
    PFN_xrConvertTimeToTimespecTimeKHR to_timespec;
    int64_t runtime_offset_ns; /* used without these functions: the runtime's clock minus the
                                  monotonic one */
    bool is_running;
} session;

static int64_t now_ns(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * ns_per_s + now.tv_nsec;
}

/* ---- records ---- */

static void put(const openxr_record *record)
{
    if (write(OPENXR_FD, record, sizeof *record) != (ssize_t)sizeof *record)
        _exit(0); /* the reader closed the pipe */
}

__attribute__((format(printf, 2, 3))) static void put_text(uint32_t kind, const char *format, ...)
{
    openxr_record record = {.magic = OPENXR_MAGIC, .kind = kind};
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(record.text, sizeof record.text, format, arguments);
    va_end(arguments);
    put(&record);
}

/* Does not ask the runtime to clean up, because it may hang after a failure. */
#define END(...) (put_text(OPENXR_END, __VA_ARGS__), _exit(1))

static void need(XrResult result, const char *what)
{
    if (XR_SUCCEEDED(result))
        return;
    if (result == XR_ERROR_SESSION_LOST || result == XR_ERROR_INSTANCE_LOST)
        END("the OpenXR runtime lost its session: is the headset still connected?");
    END("the OpenXR runtime does not provide %s (error %d): is its headset or glove connected?",
        what, (int)result);
}

/* ---- opening, in the order required by the extensions ---- */

static bool has(const XrExtensionProperties *extension, uint32_t count, const char *name)
{
    for (uint32_t i = 0; i < count; ++i)
        if (strncmp(extension[i].extensionName, name, XR_MAX_EXTENSION_NAME_SIZE) == 0)
            return true;
    return false;
}

static void open_instance(session *s)
{
    uint32_t count = 0;
    XrResult result = xrEnumerateInstanceExtensionProperties(NULL, 0, &count, NULL);
    if (result == XR_ERROR_RUNTIME_UNAVAILABLE)
        END("no active OpenXR runtime: start WiVRn, Monado or SteamVR, and its headset");
    need(result, "its list of extensions");
    XrExtensionProperties *extension = calloc(count + 1, sizeof *extension);
    if (!extension)
        END("no memory");
    for (uint32_t i = 0; i < count; ++i)
        extension[i].type = XR_TYPE_EXTENSION_PROPERTIES;
    need(xrEnumerateInstanceExtensionProperties(NULL, count, &count, extension),
         "its list of extensions");
    const char *wanted[3] = {XR_EXT_HAND_TRACKING_EXTENSION_NAME, XR_MND_HEADLESS_EXTENSION_NAME,
                             XR_KHR_CONVERT_TIMESPEC_TIME_EXTENSION_NAME};
    for (int i = 0; i < 2; ++i)
        if (!has(extension, count, wanted[i]))
            END("the OpenXR runtime lacks %s: Monado and WiVRn have it", wanted[i]);
    const bool can_convert = has(extension, count, wanted[2]);
    free(extension);

    XrInstanceCreateInfo create = {
        .type = XR_TYPE_INSTANCE_CREATE_INFO,
        .applicationInfo = {.applicationName = "marotte", .apiVersion = XR_MAKE_VERSION(1, 0, 0)},
        .enabledExtensionCount = can_convert ? 3 : 2,
        .enabledExtensionNames = wanted};
    need(xrCreateInstance(&create, &s->instance), "an instance");
    XrInstanceProperties about = {.type = XR_TYPE_INSTANCE_PROPERTIES};
    if (XR_SUCCEEDED(xrGetInstanceProperties(s->instance, &about)))
        put_text(OPENXR_NAME, "%.*s", (int)sizeof about.runtimeName, about.runtimeName);
    if (!can_convert)
        return;
    need(xrGetInstanceProcAddr(s->instance, "xrConvertTimespecTimeToTimeKHR",
                               (PFN_xrVoidFunction *)&s->from_timespec),
         "the time");
    need(xrGetInstanceProcAddr(s->instance, "xrConvertTimeToTimespecTimeKHR",
                               (PFN_xrVoidFunction *)&s->to_timespec),
         "the time");
}

static void open_session(session *s)
{
    XrSystemGetInfo get = {.type = XR_TYPE_SYSTEM_GET_INFO,
                           .formFactor = XR_FORM_FACTOR_HEAD_MOUNTED_DISPLAY};
    XrSystemId system;
    XrResult result = xrGetSystem(s->instance, &get, &system);
    if (result == XR_ERROR_FORM_FACTOR_UNAVAILABLE)
        END("the OpenXR runtime has no headset yet: connect it");
    need(result, "a headset");
    /* The list of extensions does not show whether this headset tracks hands. */
    XrSystemHandTrackingPropertiesEXT hands = {.type = XR_TYPE_SYSTEM_HAND_TRACKING_PROPERTIES_EXT};
    XrSystemProperties about = {.type = XR_TYPE_SYSTEM_PROPERTIES, .next = &hands};
    need(xrGetSystemProperties(s->instance, system, &about), "the headset's properties");
    if (!hands.supportsHandTracking)
        END("this headset tracks no hands: switch hand tracking on in its settings");
    /* No graphics binding: headless. */
    XrSessionCreateInfo create = {.type = XR_TYPE_SESSION_CREATE_INFO, .systemId = system};
    need(xrCreateSession(s->instance, &create, &s->session), "a session without pictures");
    XrReferenceSpaceCreateInfo space = {.type = XR_TYPE_REFERENCE_SPACE_CREATE_INFO,
                                        .referenceSpaceType = XR_REFERENCE_SPACE_TYPE_LOCAL,
                                        .poseInReferenceSpace = {{0, 0, 0, 1}, {0, 0, 0}}};
    need(xrCreateReferenceSpace(s->session, &space, &s->space), "a reference space");
    PFN_xrCreateHandTrackerEXT create_tracker = NULL;
    need(xrGetInstanceProcAddr(s->instance, "xrCreateHandTrackerEXT",
                               (PFN_xrVoidFunction *)&create_tracker),
         "hands");
    need(xrGetInstanceProcAddr(s->instance, "xrLocateHandJointsEXT",
                               (PFN_xrVoidFunction *)&s->locate),
         "hands");
    for (int side = 0; side < 2; ++side) {
        XrHandTrackerCreateInfoEXT tracker = {.type = XR_TYPE_HAND_TRACKER_CREATE_INFO_EXT,
                                              .hand =
                                                  side == 0 ? XR_HAND_LEFT_EXT : XR_HAND_RIGHT_EXT,
                                              .handJointSet = XR_HAND_JOINT_SET_DEFAULT_EXT};
        need(create_tracker(s->session, &tracker, &s->tracker[side]), "a hand");
    }
}

/* ---- running ---- */

static void follow_state(session *s, const XrEventDataSessionStateChanged *changed)
{
    s->runtime_offset_ns = device_time_ns(changed->time) - now_ns();
    if (changed->state == XR_SESSION_STATE_READY) {
        XrSessionBeginInfo begin = {.type = XR_TYPE_SESSION_BEGIN_INFO,
                                    .primaryViewConfigurationType =
                                        XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO};
        need(xrBeginSession(s->session, &begin), "to begin");
        s->is_running = true;
    } else if (changed->state == XR_SESSION_STATE_STOPPING) {
        s->is_running = false;
        need(xrEndSession(s->session), "to end");
    } else if (changed->state == XR_SESSION_STATE_LOSS_PENDING ||
               changed->state == XR_SESSION_STATE_EXITING) {
        END("the OpenXR runtime ended the session: is the headset still connected?");
    }
}

static void follow_events(session *s)
{
    for (;;) {
        XrEventDataBuffer event = {.type = XR_TYPE_EVENT_DATA_BUFFER};
        XrResult result = xrPollEvent(s->instance, &event);
        need(result, "its events");
        if (result == XR_EVENT_UNAVAILABLE)
            return;
        if (event.type == XR_TYPE_EVENT_DATA_INSTANCE_LOSS_PENDING)
            END("the OpenXR runtime is shutting down");
        if (event.type == XR_TYPE_EVENT_DATA_SESSION_STATE_CHANGED) {
            XrEventDataSessionStateChanged changed;
            memcpy(&changed, &event, sizeof changed);
            follow_state(s, &changed);
        }
    }
}

static XrTime runtime_now(const session *s)
{
    struct timespec now;
    XrTime time = 0;
    if (!s->from_timespec)
        return now_ns() + s->runtime_offset_ns;
    clock_gettime(CLOCK_MONOTONIC, &now);
    need(s->from_timespec(s->instance, &now, &time), "the time");
    return time;
}

static int64_t to_monotonic(const session *s, XrTime time)
{
    struct timespec at;
    if (!s->to_timespec)
        return device_time_ns(time) - s->runtime_offset_ns;
    need(s->to_timespec(s->instance, time, &at), "the time");
    const int64_t most_s = DEVICE_TIME_MAX_NS / ns_per_s;
    if (at.tv_sec < -most_s || at.tv_sec > most_s || at.tv_nsec < 0 || at.tv_nsec >= ns_per_s)
        return INT64_MAX; /* out of range: the reader drops the frame */
    return (int64_t)at.tv_sec * ns_per_s + at.tv_nsec;
}

static void locate(const session *s, int side, XrTime time, openxr_hand *out)
{
    XrHandJointLocationEXT joint[OPENXR_JOINTS];
    XrHandJointsLocateInfoEXT ask = {
        .type = XR_TYPE_HAND_JOINTS_LOCATE_INFO_EXT, .baseSpace = s->space, .time = time};
    XrHandJointLocationsEXT found = {.type = XR_TYPE_HAND_JOINT_LOCATIONS_EXT,
                                     .jointCount = OPENXR_JOINTS,
                                     .jointLocations = joint};
    memset(joint, 0, sizeof joint);
    XrResult result = s->locate(s->tracker[side], &ask, &found);
    if (result == XR_ERROR_TIME_INVALID) /* the hand is not located now */
        return;
    need(result, "the hand's joints");
    out->active = found.isActive == XR_TRUE;
    for (uint32_t i = 0; i < OPENXR_JOINTS; ++i) {
        const XrHandJointLocationEXT *j = &joint[i];
        if (j->locationFlags & XR_SPACE_LOCATION_POSITION_VALID_BIT)
            out->valid |= UINT32_C(1) << i;
        if (j->locationFlags & XR_SPACE_LOCATION_POSITION_TRACKED_BIT)
            out->tracked |= UINT32_C(1) << i;
        out->at[i][0] = j->pose.position.x;
        out->at[i][1] = j->pose.position.y;
        out->at[i][2] = j->pose.position.z;
    }
}

int main(void)
{
    struct stat about;
    if (fstat(OPENXR_FD, &about) != 0 || !S_ISFIFO(about.st_mode)) {
        (void)fprintf(stderr, "marotte-openxr-hands is started by marotte: --input openxr\n");
        return 2;
    }
    /* Runtimes start other programs, which must not keep the pipe open. */
    (void)fcntl(OPENXR_FD, F_SETFD, FD_CLOEXEC);
    (void)prctl(PR_SET_PDEATHSIG, SIGKILL);
    session s = {.runtime_offset_ns = 0};
    open_instance(&s);
    open_session(&s);
    for (int64_t next_ns = now_ns();; next_ns += tick_ns) {
        openxr_record record = {.magic = OPENXR_MAGIC, .kind = OPENXR_FRAME};
        follow_events(&s);
        record.time_ns = now_ns();
        if (s.is_running) {
            XrTime time = runtime_now(&s);
            record.time_ns = to_monotonic(&s, time);
            for (int side = 0; side < 2; ++side)
                locate(&s, side, time, &record.hand[side]);
        }
        put(&record);
        int64_t now = now_ns();
        next_ns = next_ns + tick_ns > now ? next_ns : now - tick_ns;
        const int64_t until_ns = next_ns + tick_ns;
        const struct timespec until = {(time_t)(until_ns / ns_per_s), (long)(until_ns % ns_per_s)};
        (void)clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, NULL);
    }
}
