/* An OpenXR runtime without a headset: two hands of our own skeleton that bend two fingers,
 * 60 new frames a second. MAROTTE_TEST_OPENXR says how it misbehaves:
 *   inactive, untracked       no hand; a hand that is guessed
 *   nan, back, far            joints that are no numbers, a clock that steps back, times at both
 *                             ends of 64 bits: now and then
 *   freeze                    the same frame for ever, after half a second
 *   loss, hang, crash, end    after half a second
 *   no_hands, no_headless, no_clock, no_headset      what it lacks
 * The knuckles of index and middle finger tell the time of the frame, as the hands of a clock do:
 * 0.6 rad and 0.4 of the sine and cosine of a turn a second (tests/device/openxr.c reads it). */
#include "hand/hand.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define XR_USE_TIMESPEC
#include <openxr/openxr.h>
#include <openxr/openxr_platform.h>

/* The loader's, which Debian's package has not. */
typedef struct loader_info {
    int32_t type;
    uint32_t version;
    size_t size;
    uint32_t least_interface, most_interface;
    uint64_t least_api, most_api;
} loader_info;
typedef struct runtime_request {
    int32_t type;
    uint32_t version;
    size_t size;
    uint32_t interface_version;
    uint64_t api_version;
    PFN_xrGetInstanceProcAddr get;
} runtime_request;

/* Its own clock is not the system's. */
static const int64_t clock_offset_ns = 7000000000000000, ns_per_s = 1000000000;
static int state_sent, tick;
static hand_skeleton *skeleton[2];

static int is_mode(const char *mode)
{
    const char *wanted = getenv("MAROTTE_TEST_OPENXR");
    return wanted && strcmp(wanted, mode) == 0;
}

static XRAPI_ATTR XrResult XRAPI_CALL enumerate_extensions(const char *layer, uint32_t capacity,
                                                           uint32_t *count,
                                                           XrExtensionProperties *out)
{
    const char *name[3] = {XR_EXT_HAND_TRACKING_EXTENSION_NAME};
    uint32_t n = 1;
    (void)layer;
    if (!is_mode("no_headless"))
        name[n++] = XR_MND_HEADLESS_EXTENSION_NAME;
    if (!is_mode("no_clock"))
        name[n++] = XR_KHR_CONVERT_TIMESPEC_TIME_EXTENSION_NAME;
    *count = n;
    for (uint32_t i = 0; i < n && i < capacity; ++i)
        (void)snprintf(out[i].extensionName, sizeof out[i].extensionName, "%s", name[i]);
    return XR_SUCCESS;
}

static XRAPI_ATTR XrResult XRAPI_CALL create_instance(const XrInstanceCreateInfo *info,
                                                      XrInstance *out)
{
    (void)info;
    skeleton[0] = hand_skeleton_create(MRT_LEFT, 190);
    skeleton[1] = hand_skeleton_create(MRT_RIGHT, 190);
    *out = (XrInstance)(uintptr_t)1;
    return XR_SUCCESS;
}

static XRAPI_ATTR XrResult XRAPI_CALL destroy_instance(XrInstance instance)
{
    (void)instance;
    return XR_SUCCESS;
}

static XRAPI_ATTR XrResult XRAPI_CALL instance_properties(XrInstance instance,
                                                          XrInstanceProperties *out)
{
    (void)instance;
    (void)snprintf(out->runtimeName, sizeof out->runtimeName, "marotte's\033[31m double");
    return XR_SUCCESS;
}

static XRAPI_ATTR XrResult XRAPI_CALL get_system(XrInstance instance, const XrSystemGetInfo *info,
                                                 XrSystemId *out)
{
    (void)instance;
    (void)info;
    *out = 1;
    return is_mode("no_headset") ? XR_ERROR_FORM_FACTOR_UNAVAILABLE : XR_SUCCESS;
}

static XRAPI_ATTR XrResult XRAPI_CALL system_properties(XrInstance instance, XrSystemId system,
                                                        XrSystemProperties *out)
{
    (void)instance;
    (void)system;
    XrSystemHandTrackingPropertiesEXT *hands = out->next;
    hands->supportsHandTracking = !is_mode("no_hands");
    return XR_SUCCESS;
}

static XRAPI_ATTR XrResult XRAPI_CALL create_session(XrInstance instance,
                                                     const XrSessionCreateInfo *info,
                                                     XrSession *out)
{
    (void)instance;
    *out = (XrSession)(uintptr_t)2;
    return info->next ? XR_ERROR_GRAPHICS_DEVICE_INVALID : XR_SUCCESS;
}

static XRAPI_ATTR XrResult XRAPI_CALL create_space(XrSession session,
                                                   const XrReferenceSpaceCreateInfo *info,
                                                   XrSpace *out)
{
    (void)session;
    (void)info;
    *out = (XrSpace)(uintptr_t)3;
    return XR_SUCCESS;
}

static int64_t monotonic_ns(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * ns_per_s + now.tv_nsec;
}

static XRAPI_ATTR XrResult XRAPI_CALL poll_event(XrInstance instance, XrEventDataBuffer *out)
{
    static const XrSessionState states[] = {XR_SESSION_STATE_IDLE, XR_SESSION_STATE_READY,
                                            XR_SESSION_STATE_SYNCHRONIZED, XR_SESSION_STATE_VISIBLE,
                                            XR_SESSION_STATE_FOCUSED};
    (void)instance;
    const int is_lost = is_mode("loss") && tick > 200 && state_sent == 5;
    if (state_sent >= 5 && !is_lost)
        return XR_EVENT_UNAVAILABLE;
    XrEventDataSessionStateChanged changed = {.type = XR_TYPE_EVENT_DATA_SESSION_STATE_CHANGED,
                                              .session = (XrSession)(uintptr_t)2,
                                              .state = is_lost ? XR_SESSION_STATE_LOSS_PENDING
                                                               : states[state_sent],
                                              .time = monotonic_ns() + clock_offset_ns};
    ++state_sent;
    memcpy(out, &changed, sizeof changed);
    return XR_SUCCESS;
}

static XRAPI_ATTR XrResult XRAPI_CALL begin_session(XrSession session,
                                                    const XrSessionBeginInfo *info)
{
    (void)session;
    (void)info;
    return state_sent >= 2 ? XR_SUCCESS : XR_ERROR_SESSION_NOT_READY;
}

static XRAPI_ATTR XrResult XRAPI_CALL end_session(XrSession session)
{
    (void)session;
    return XR_SUCCESS;
}

static XRAPI_ATTR XrResult XRAPI_CALL create_tracker(XrSession session,
                                                     const XrHandTrackerCreateInfoEXT *info,
                                                     XrHandTrackerEXT *out)
{
    (void)session;
    *out = (XrHandTrackerEXT)(uintptr_t)(info->hand == XR_HAND_LEFT_EXT ? 10 : 11);
    return XR_SUCCESS;
}

static void misbehave(void)
{
    ++tick; /* of each hand */
    if (tick < 200)
        return;
    if (is_mode("hang"))
        for (;;)
            (void)pause();
    if (is_mode("crash"))
        (void)raise(SIGSEGV);
    if (is_mode("end"))
        _exit(7); /* with that code whatever a sanitizer finds at exit */
}

static XRAPI_ATTR XrResult XRAPI_CALL locate(XrHandTrackerEXT tracker,
                                             const XrHandJointsLocateInfoEXT *info,
                                             XrHandJointLocationsEXT *out)
{
    static const int joint[MRT_JOINTS] = {1,  2,  3,  4,  5,  7,  8,  9,  10, 12, 13,
                                          14, 15, 17, 18, 19, 20, 22, 23, 24, 25};
    static int64_t frozen_ns;
    const rigid still = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0, 0, 0}};
    mrt_vec3 at[MRT_JOINTS], palm[MRT_PALM];
    misbehave();
    out->isActive = !is_mode("inactive");
    int64_t time_ns = info->time - clock_offset_ns;
    time_ns -= time_ns % (ns_per_s / 60);
    if (tick < 200)
        frozen_ns = time_ns;
    if (is_mode("freeze"))
        time_ns = frozen_ns;
    float angle[MRT_ANGLES] = {0.6f, 0.2f, 0.3f, 0.5f, 0.0f, 0.4f, 0.2f, 0.3f, 0.2f, 0.1f,
                               0.1f, 0.3f, 0.4f, 0.3f, 0.1f, 0.3f, 0.5f, 0.3f, 0.1f, 0.12f};
    const double turn_rad = 6.283185307179586 * (double)(time_ns % ns_per_s) / 1e9;
    angle[4] = (float)(0.6 + 0.4 * sin(turn_rad));
    angle[7] = (float)(0.6 + 0.4 * cos(turn_rad));
    hand_pose(skeleton[tracker == (XrHandTrackerEXT)(uintptr_t)11], angle, &still, at, palm);
    const XrSpaceLocationFlags flags =
        is_mode("untracked")
            ? XR_SPACE_LOCATION_POSITION_VALID_BIT
            : XR_SPACE_LOCATION_POSITION_VALID_BIT | XR_SPACE_LOCATION_POSITION_TRACKED_BIT;
    for (uint32_t i = 0; i < out->jointCount; ++i)
        out->jointLocations[i] =
            (XrHandJointLocationEXT){.locationFlags = flags, .pose = {{0, 0, 0, 1}, {0, 1.2f, 0}}};
    for (int i = 0; i < MRT_JOINTS; ++i) /* m; the headset's frame: +y up, -z forward */
        out->jointLocations[joint[i]].pose.position =
            (XrVector3f){-0.001f * at[i].x, 1.2f + 0.001f * at[i].y, -0.4f - 0.001f * at[i].z};
    if (is_mode("nan") && tick % 7 < 3)
        out->jointLocations[8].pose.position.x = tick % 7 == 0 ? NAN : 1e30f;
    return XR_SUCCESS;
}

static XRAPI_ATTR XrResult XRAPI_CALL to_time(XrInstance instance, const struct timespec *at,
                                              XrTime *out)
{
    (void)instance;
    *out = (int64_t)at->tv_sec * ns_per_s + at->tv_nsec + clock_offset_ns;
    if (is_mode("back") && tick % 20 < 4)
        *out -= 80000000;
    return XR_SUCCESS;
}

static XRAPI_ATTR XrResult XRAPI_CALL to_timespec(XrInstance instance, XrTime time,
                                                  struct timespec *out)
{
    (void)instance;
    time -= clock_offset_ns;
    *out = (struct timespec){(time_t)(time / ns_per_s), (long)(time % ns_per_s)};
    if (is_mode("far") && tick % 20 < 4) /* times that no clock has */
        *out = (struct timespec){tick % 20 < 2 ? INT64_MAX / ns_per_s : INT64_MIN, 999999999};
    return XR_SUCCESS;
}

static XRAPI_ATTR XrResult XRAPI_CALL get(XrInstance instance, const char *name,
                                          PFN_xrVoidFunction *out)
{
#define CALL(function) (PFN_xrVoidFunction)(void (*)(void)) function
    const struct {
        const char *name;
        PFN_xrVoidFunction function;
    } calls[] = {{"xrEnumerateInstanceExtensionProperties", CALL(enumerate_extensions)},
                 {"xrGetInstanceProcAddr", CALL(get)},
                 {"xrCreateInstance", CALL(create_instance)},
                 {"xrDestroyInstance", CALL(destroy_instance)},
                 {"xrGetInstanceProperties", CALL(instance_properties)},
                 {"xrGetSystem", CALL(get_system)},
                 {"xrGetSystemProperties", CALL(system_properties)},
                 {"xrCreateSession", CALL(create_session)},
                 {"xrCreateReferenceSpace", CALL(create_space)},
                 {"xrPollEvent", CALL(poll_event)},
                 {"xrBeginSession", CALL(begin_session)},
                 {"xrEndSession", CALL(end_session)},
                 {"xrCreateHandTrackerEXT", CALL(create_tracker)},
                 {"xrLocateHandJointsEXT", CALL(locate)},
                 {"xrConvertTimespecTimeToTimeKHR", CALL(to_time)},
                 {"xrConvertTimeToTimespecTimeKHR", CALL(to_timespec)}};
    (void)instance;
    *out = NULL;
    for (size_t i = 0; i < sizeof calls / sizeof *calls; ++i)
        if (strcmp(name, calls[i].name) == 0)
            *out = calls[i].function;
    return *out ? XR_SUCCESS : XR_ERROR_FUNCTION_UNSUPPORTED;
}

MRT_EXPORT XrResult xrNegotiateLoaderRuntimeInterface(const loader_info *info,
                                                      runtime_request *out);
XrResult xrNegotiateLoaderRuntimeInterface(const loader_info *info, runtime_request *out)
{
    if (info->least_interface > 1)
        return XR_ERROR_INITIALIZATION_FAILED;
    out->interface_version = 1;
    out->api_version = XR_CURRENT_API_VERSION;
    out->get = get;
    return XR_SUCCESS;
}
