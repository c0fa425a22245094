/* vts.c - the plugin "org.marotte.vts": the face as parameters of VTube Studio, by its public API
 * over WebSocket. It requests a token once, which the user allows in VTube Studio, and stores it.
 * Then it creates parameters for ARKit's 52 shapes and sends values. It only sends names that VTube
 * Studio knows, because an unknown name would make the whole request fail. It reconnects every
 * second while VTube Studio does not answer. */
#include "websocket.h"
#include "device_io.h"
#include "udp.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>
#include <sys/stat.h>
#include <fcntl.h>

enum { PORT = 8001, SHAPES = 52, CHANNELS = 61, PARAMETERS = SHAPES + 14, PATH_BYTES = 4096 };
enum { RATE, FORGET, PARAM_COUNT };
static const char plugin_name[] = "marotte", developer[] = "marotte";
static const int64_t again_ns = 1000000000, stuck_ns = 5000000000;

typedef enum stage {
    STAGE_AWAY = 0,
    STAGE_TOKEN, /* requested: the user must allow it in VTube Studio */
    STAGE_LOGIN, /* token sent */
    STAGE_LIST,  /* list of parameters requested */
    STAGE_READY
} stage;

typedef struct parameter {
    char name[40];
    uint32_t weight;      /* index in the weights of the face */
    double low, high, by; /* value = weight * by, within */
    bool is_own;          /* created by this plugin */
    bool is_known;        /* VTube Studio has it */
} parameter;

struct mrt_plugin {
    const mrt_host *host;
    websocket socket;
    stage stage;
    char host_name[UDP_HOST], token[128], token_path[PATH_BYTES];
    uint16_t port;
    int64_t tried_ns, idle_ns;
    bool is_told; /* the warning that the user must allow it */
    const mrt_face_names *names;
    parameter parameter[PARAMETERS];
    uint32_t count;
};

/* ---- values to send ---- */

/* VTube Studio's own parameters, from ARKit's shapes and from rotations. */
static const struct {
    const char *name, *weight;
    double by, low, high;
} usual[] = {{"FaceAngleX", "HeadYaw", 57.29577951308232, -30, 30},
             {"FaceAngleY", "HeadPitch", 57.29577951308232, -30, 30},
             {"FaceAngleZ", "HeadRoll", 57.29577951308232, -90, 90},
             {"MouthOpen", "JawOpen", 1, 0, 1},
             {"TongueOut", "TongueOut", 1, 0, 1},
             {"CheekPuff", "CheekPuff", 1, 0, 1},
             {"EyeLeftX", "LeftEyeYaw", 2, -1, 1},
             {"EyeLeftY", "LeftEyePitch", 2, -1, 1},
             {"EyeRightX", "RightEyeYaw", 2, -1, 1},
             {"EyeRightY", "RightEyePitch", 2, -1, 1},
             {"EyeOpenLeft", "EyeBlinkLeft", -1, 0, 1},
             {"EyeOpenRight", "EyeBlinkRight", -1, 0, 1}};
enum { USUAL = sizeof usual / sizeof *usual };

static uint32_t weight_named(const mrt_face_names *n, const char *name)
{
    for (uint32_t i = 0; i < n->weight_count && i < CHANNELS; ++i)
        if (strcmp(n->weights[i], name) == 0)
            return i;
    return UINT32_MAX;
}

static void list_parameters(mrt_plugin *self)
{
    const mrt_face_names *n = self->names;
    self->count = 0;
    for (uint32_t i = 0; i < USUAL; ++i) {
        uint32_t weight = weight_named(n, usual[i].weight);
        if (weight == UINT32_MAX)
            continue;
        parameter *p = &self->parameter[self->count++];
        *p = (parameter){
            .weight = weight, .low = usual[i].low, .high = usual[i].high, .by = usual[i].by};
        (void)snprintf(p->name, sizeof p->name, "%s", usual[i].name);
    }
    for (uint32_t i = 0; i < SHAPES && n->weight_count >= CHANNELS; ++i) {
        parameter *p = &self->parameter[self->count++];
        *p = (parameter){.weight = i, .high = 1, .by = 1, .is_own = true};
        (void)snprintf(p->name, sizeof p->name, "Marotte%.24s", n->weights[i]);
    }
}

/* The openness of an eye is 1 minus its closure. */
static double value_of(const parameter *p, const mrt_face_sample *sample)
{
    double weight = (double)sample->weights[p->weight];
    double value = p->by < 0.0 ? 1.0 - weight : weight * p->by;
    return fmin(fmax(value, p->low), p->high);
}

/* Takes `data` over. */
static bool ask(mrt_plugin *self, const char *type, json_t *data)
{
    json_t *request = json_pack("{s:s, s:s, s:s, s:s, s:o}", "apiName", "VTubeStudioPublicAPI",
                                "apiVersion", "1.0", "requestID", type, "messageType", type, "data",
                                data ? data : json_object());
    char *text = request ? json_dumps(request, JSON_COMPACT | JSON_REAL_PRECISION(6)) : NULL;
    bool was_sent = text && websocket_send(&self->socket, text, strlen(text));
    free(text);
    json_decref(request);
    return was_sent;
}

static json_t *who(void)
{
    return json_pack("{s:s, s:s}", "pluginName", plugin_name, "pluginDeveloper", developer);
}

static void request_token(mrt_plugin *self)
{
    self->token[0] = '\0';
    self->stage = STAGE_TOKEN;
    (void)ask(self, "AuthenticationTokenRequest", who());
    if (!self->is_told)
        device_log(self->host, MRT_LOG_WARNING, "allow marotte in the dialog of VTube Studio");
    self->is_told = true;
}

static void log_in(mrt_plugin *self)
{
    json_t *data = who();
    if (!self->token[0]) {
        json_decref(data);
        request_token(self);
        return;
    }
    json_object_set_new(data, "authenticationToken", json_string(self->token));
    self->stage = STAGE_LOGIN;
    (void)ask(self, "AuthenticationRequest", data);
}

static void ask_for_list(mrt_plugin *self)
{
    self->stage = STAGE_LIST;
    (void)ask(self, "InputParameterListRequest", NULL);
}

static void create_missing(mrt_plugin *self)
{
    self->stage = STAGE_READY;
    for (uint32_t i = 0; i < self->count; ++i) {
        const parameter *p = &self->parameter[i];
        if (p->is_known || !p->is_own)
            continue;
        (void)ask(self, "ParameterCreationRequest",
                  json_pack("{s:s, s:s, s:f, s:f, s:f}", "parameterName", p->name, "explanation",
                            "from marotte", "min", p->low, "max", p->high, "defaultValue", 0.0));
    }
}

static void inject(mrt_plugin *self, const mrt_face_sample *sample)
{
    json_t *values = json_array();
    for (uint32_t i = 0; i < self->count; ++i)
        if (self->parameter[i].is_known)
            json_array_append_new(values,
                                  json_pack("{s:s, s:f}", "id", self->parameter[i].name, "value",
                                            value_of(&self->parameter[i], sample)));
    if (json_array_size(values) == 0) {
        json_decref(values);
        return;
    }
    (void)ask(
        self, "InjectParameterDataRequest",
        json_pack("{s:b, s:s, s:o}", "faceFound", 1, "mode", "set", "parameterValues", values));
}

/* ---- storing the token ---- */

static void read_token(mrt_plugin *self)
{
    FILE *file = self->token_path[0] ? fopen(self->token_path, "re") : NULL;
    if (file && !fgets(self->token, sizeof self->token, file))
        self->token[0] = '\0';
    if (file)
        (void)fclose(file);
    self->token[strcspn(self->token, "\r\n")] = '\0';
}

/* Readable only by the user. */
static void keep_token(mrt_plugin *self)
{
    int fd = self->token_path[0]
                 ? open(self->token_path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600)
                 : -1;
    size_t size = strlen(self->token);
    if (fd < 0 || write(fd, self->token, size) != (ssize_t)size)
        device_log(self->host, MRT_LOG_WARNING,
                   "cannot store the token: VTube Studio will ask again next time");
    if (fd >= 0)
        (void)close(fd);
}

/* ---- received messages ---- */

static parameter *find(mrt_plugin *self, const char *name)
{
    for (uint32_t i = 0; name && i < self->count; ++i)
        if (strcmp(self->parameter[i].name, name) == 0)
            return &self->parameter[i];
    return NULL;
}

static void note_names(mrt_plugin *self, const json_t *list)
{
    for (size_t i = 0; i < json_array_size(list); ++i) {
        parameter *p =
            find(self, json_string_value(json_object_get(json_array_get(list, i), "name")));
        if (p)
            p->is_known = true;
    }
}

static void hear_list(mrt_plugin *self, const json_t *data)
{
    for (uint32_t i = 0; i < self->count; ++i)
        self->parameter[i].is_known = false;
    note_names(self, json_object_get(data, "defaultParameters"));
    note_names(self, json_object_get(data, "customParameters"));
    create_missing(self);
}

static void hear_token(mrt_plugin *self, const json_t *data)
{
    const char *token = json_string_value(json_object_get(data, "authenticationToken"));
    if (!token || strlen(token) >= sizeof self->token)
        return;
    (void)snprintf(self->token, sizeof self->token, "%s", token);
    keep_token(self);
    log_in(self);
}

static void hear_error(mrt_plugin *self, const char *of)
{
    if (!of)
        return;
    if (strcmp(of, "AuthenticationTokenRequest") == 0)
        websocket_close(&self->socket); /* not allowed: request it again after reconnecting */
    else if (strcmp(of, "InjectParameterDataRequest") == 0)
        ask_for_list(self); /* a parameter was removed */
}

static void hear(mrt_plugin *self, const char *text)
{
    json_t *message = json_loads(text, JSON_REJECT_DUPLICATES, NULL);
    const char *type = json_string_value(json_object_get(message, "messageType"));
    const json_t *data = json_object_get(message, "data");
    if (!type)
        type = "";
    if (strcmp(type, "AuthenticationTokenResponse") == 0) {
        hear_token(self, data);
    } else if (strcmp(type, "AuthenticationResponse") == 0) {
        if (json_is_true(json_object_get(data, "authenticated")))
            ask_for_list(self);
        else
            request_token(self);
    } else if (strcmp(type, "InputParameterListResponse") == 0) {
        hear_list(self, data);
    } else if (strcmp(type, "ParameterCreationResponse") == 0) {
        parameter *p = find(self, json_string_value(json_object_get(data, "parameterName")));
        if (p)
            p->is_known = true;
    } else if (strcmp(type, "APIError") == 0) {
        hear_error(self, json_string_value(json_object_get(message, "requestID")));
    }
    json_decref(message);
}

/* ---- the interface ---- */

static mrt_plugin *create(const mrt_host *host)
{
    mrt_plugin *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->host = host;
    if (websocket_init(&self->socket)) {
        const mrt_folders *folders = host->service(host, MRT_FOLDERS);
        char folder[PATH_BYTES - 16] = "";
        if (folders && folders->settings(host, folder, sizeof folder) >= 0 && folder[0])
            (void)snprintf(self->token_path, sizeof self->token_path, "%s/token", folder);
        return self;
    }
    websocket_finish(&self->socket);
    free(self);
    return NULL;
}

static void destroy(mrt_plugin *self)
{
    if (!self)
        return;
    websocket_finish(&self->socket);
    free(self);
}

static mrt_result open_output(mrt_plugin *self, const char *address, const double *params,
                              mrt_face_wants *wants)
{
    (void)snprintf(self->host_name, sizeof self->host_name, "127.0.0.1");
    self->port = PORT;
    if (address[0] && !udp_address_parse(self->host_name, &self->port, address, strlen(address))) {
        device_log(self->host, MRT_LOG_ERROR,
                   "\"%.100s\" is not an address: expected HOST:PORT, as in 192.168.1.20:%d",
                   address, PORT);
        return MRT_ERR_ARGUMENT;
    }
    wants->rate_hz = params[RATE];
    wants->repeat_s =
        0.1; /* after a second without values, VTube Studio takes control of the face again */
    self->tried_ns = 0;
    self->is_told = false;
    self->token[0] = '\0';
    if (params[FORGET] < 0.5)
        read_token(self);
    return MRT_OK;
}

static mrt_result begin(mrt_plugin *self, const mrt_face_names *names)
{
    self->names = names;
    list_parameters(self);
    if (self->stage >= STAGE_LIST && self->socket.state == WEBSOCKET_OPEN)
        ask_for_list(self);
    return MRT_OK;
}

static void go_on(mrt_plugin *self)
{
    int64_t now_ns = device_clock_ns();
    if (self->socket.state == WEBSOCKET_CLOSED) {
        self->stage = STAGE_AWAY;
        if (self->tried_ns && now_ns - self->tried_ns < again_ns)
            return;
        self->tried_ns = now_ns;
        self->idle_ns = now_ns;
        (void)websocket_connect(&self->socket, self->host_name, self->port);
    }
    if (!websocket_step(&self->socket))
        return;
    if (websocket_is_idle(&self->socket) && self->socket.state == WEBSOCKET_OPEN)
        self->idle_ns = now_ns;
    else if (now_ns - self->idle_ns > stuck_ns)
        websocket_close(&self->socket);
    if (self->socket.state == WEBSOCKET_OPEN && self->stage == STAGE_AWAY)
        log_in(self);
    for (const char *text = websocket_receive(&self->socket); text;
         text = websocket_receive(&self->socket))
        hear(self, text);
    (void)websocket_step(&self->socket); /* its answers and pongs must not delay a face */
}

static mrt_result send_face(mrt_plugin *self, const double *params, const mrt_face_sample *sample)
{
    (void)params;
    go_on(self);
    if (self->stage == STAGE_READY && websocket_is_idle(&self->socket))
        inject(self, sample);
    if (self->socket.state == WEBSOCKET_OPEN)
        (void)websocket_step(&self->socket);
    return self->socket.state == WEBSOCKET_OPEN && self->stage == STAGE_READY ? MRT_OK
                                                                              : MRT_TIMEOUT;
}

static void close_output(mrt_plugin *self)
{
    websocket_close(&self->socket);
    self->stage = STAGE_AWAY;
}

static const char *const off_on[] = {"off", "on", NULL};
static const mrt_param params[PARAM_COUNT] = {
    [RATE] = {1, 0, "Rate", "Network", "Hz",
              "Largest number of faces per second. Used when the output is opened again", 1, 120,
              60, NULL},
    [FORGET] = {2, MRT_PARAM_STEPPED, "Ask again", "Network", "",
                "Ignore the stored token, so that VTube Studio asks again", 0, 1, 0, off_on},
};
static const mrt_face_output output = {open_output, begin, send_face, close_output};
static const mrt_interface interfaces[] = {{MRT_FACE_OUTPUT, &output}, {NULL, NULL}};
static const mrt_plugin_type type = {
    MRT_ABI,
    PARAM_COUNT,
    params,
    interfaces,
    "org.marotte.vts",
    "VTube Studio",
    MAROTTE_VERSION,
    "The face as parameters of VTube Studio, through its WebSocket API",
    create,
    destroy,
};

MRT_EXPORT const mrt_plugin_type *const marotte_plugins[] = {&type, NULL};
