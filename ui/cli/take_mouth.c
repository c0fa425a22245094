/* take mouth: a voice moves the mouth of a take, or of a new one. */
#include "base/clock.h"
#include "base/file.h"
#include "stage/perform/composer.h"
#include "stage/playback/kept_solver.h"
#include "stage/record/recorder.h"
#include "stage/voice/voice_mouth.h"
#include "cli/take.h"
#include "cli/terminal.h"
#include "show/edit_store.h"
#include "show/sound_file.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct speaking {
    take_call *call;
    take take;
    face_file face;
    char *face_path;
    take_performance like; /* of --face */
    file_bytes words;      /* of --words-file */
    voice_mouth_settings settings;
    voice_mouth_report report;
    phone_list sounds;
} speaking;

/* ---- the options ---- */

static mrt_result read_options(speaking *self, error *err)
{
    take_call *call = self->call;
    const char *file = call->text[TAKE_WORDS_FILE];
    voice_mouth_settings *s = &self->settings;
    *s = (voice_mouth_settings){.take = &self->take, .jaw = 1.0, .lips = 1.0};
    s->phones = (phones_settings){call->text[TAKE_WORDS], progress_part, &call->shown};
    if (file && s->phones.words)
        return take_misused(call, err, "give either --words or --words-file");
    if (!call->word[1] == !call->text[TAKE_SOUND])
        return take_misused(call, err, "give either a TAKE or --sound FILE, which makes a take");
    if (call->text[TAKE_SOUND] && !call->text[TAKE_FACE])
        return take_misused(call, err, "--sound needs --face FILE: the face that speaks");
    mrt_result result = take_number(call, TAKE_JAW, 0.0, VOICE_MOUTH_AXIS_MOST, &s->jaw, err);
    if (result >= 0)
        result = take_number(call, TAKE_LIPS, 0.0, VOICE_MOUTH_AXIS_MOST, &s->lips, err);
    if (result >= 0 && file) {
        result = file_read(&self->words, file, PHONES_WORDS_BYTES, err);
        s->phones.words = (const char *)self->words.data;
    }
    return result;
}

/* ---- the show, the take and its face ---- */

static mrt_result open_show(take_call *call, error *err)
{
    const char *path = call->word[0];
    const bool is_new = call->text[TAKE_SOUND] && access(path, F_OK) != 0 && errno == ENOENT;
    mrt_result result = is_new ? show_create(&call->show, path, err)
                               : show_open(&call->show, path, SHOW_WRITE, err);
    if (result >= 0 && !show_is_writable(call->show))
        return error_set(err, MRT_ERR_IO, "%s", show_notice(call->show));
    return result;
}

/* Makes a take that has only a sound. */
static mrt_result make_take(take_call *call, char id[32], error *err)
{
    const sound_file_watch watch = {progress_part, &call->shown};
    show_audio audio;
    edit attach;
    char *json = NULL;
    int64_t made_id = 0;
    edit_init(&attach, EDIT_AUDIO_ATTACH);
    attach.offset_ns = 0;
    progress_start(&call->shown, "sound");
    mrt_result result =
        sound_file_import(&attach.audio, call->show, call->text[TAKE_SOUND], &watch, err);
    progress_end(&call->shown);
    if (result == MRT_OK)
        result = show_audio_info(call->show, attach.audio, &audio, err);
    if (result == MRT_OK)
        result = edit_write(&json, &attach, err);
    if (result == MRT_OK) {
        const char *const edits[] = {json};
        const int64_t utc_ms = clock_utc_ms();
        const int64_t length_ns = (int64_t)(1e9 * (double)audio.frame_count / audio.rate_hz);
        const show_new_take made = {.created_ns = utc_ms * NS_PER_MS,
                                    .start_ns = utc_ms * NS_PER_MS,
                                    .end_ns = utc_ms * NS_PER_MS + length_ns,
                                    .scene = "",
                                    .shot = "",
                                    .origin = "made from a voice",
                                    .base_edits = edits,
                                    .base_edit_count = 1,
                                    .utc_ms = utc_ms};
        result = show_take_create(call->show, &made, &made_id, err);
    }
    free(json);
    (void)snprintf(id, 32, "%lld", (long long)made_id);
    return result;
}

static mrt_result check_face(const face_file *of, error *err)
{
    composer *c;
    const csrbf_settings solver = kept_solver_for(NULL, of, NULL);
    mrt_result result = composer_create(&c, of, &solver, err);
    if (result < 0)
        return result;
    const mapped_face *mapped = composer_mapped(c);
    result = voice_mouth_check_face(mapped->pose, mapped->pose_count, err);
    composer_destroy(c);
    return result;
}

static mrt_result open_face(speaking *self, error *err)
{
    take_call *call = self->call;
    const char *path = call->text[TAKE_FACE];
    mrt_result result = MRT_OK;
    if (path) {
        result = face_file_read(&self->face, path, NULL, FACE_FILE_USABLE, err);
        if (result >= 0)
            result = recorder_face_identity(&self->like, &self->face, path, 0.0, err);
        self->settings.like = &self->like;
    } else if (self->take.audio.audio && self->take.layer_count > 0) {
        result = take_face_read(&self->face, &self->face_path, call, &self->take, NULL, err);
    } else {
        return MRT_OK; /* voice_mouth_make says what is missing */
    }
    return result < 0 ? result : check_face(&self->face, err);
}

/* ---- the result ---- */

static mrt_result add_layer(speaking *self, const edit *e, error *err)
{
    edit_store *store;
    history *of;
    mrt_result result = edit_store_open(&store, self->call->show, self->take.id, clock_utc_ms, err);
    if (result < 0)
        return result;
    history_store list = edit_store_list(store);
    result = history_open(&of, edit_store_bare(store), &list, err);
    if (result >= 0) {
        result = history_do(of, e, err);
        if (result >= 0)
            facts_list(self->call->told, "edits", "edit", history_words(of, history_head(of)));
        history_close(of);
    }
    edit_store_close(store);
    return result;
}

/* "0.310,0.370,HH": for other programs, and for tests of the recognition. */
static mrt_result write_sounds(const speaking *self, const char *path, error *err)
{
    file_writer out;
    mrt_result result = file_writer_open(&out, path, err);
    if (result < 0)
        return result;
    fputs("start_s,end_s,sound\n", out.stream);
    for (uint32_t i = 0; i < self->sounds.count; ++i) {
        const phone *p = &self->sounds.phone[i];
        fprintf(out.stream, "%.3f,%.3f,%s\n", p->start_s, p->end_s, phone_name[p->sound]);
    }
    return file_writer_commit(&out, err);
}

static void report(const speaking *self)
{
    facts *told = self->call->told;
    const phones_report *p = &self->report.phones;
    facts_text(told, "take", "take",
               take_slate_text(self->take.scene, self->take.shot, self->take.number).text);
    facts_number(told, "take_id", "take id", (double)self->take.id, 0, "");
    facts_number(told, "sounds", "sounds", p->sound_count, 0, "");
    facts_number(told, "voice_s", "voice", self->report.length_s, 2, "s");
    if (p->word_count > 0)
        facts_number(told, "words", "words", p->word_count, 0, "");
    if (p->unknown_count > 0) {
        facts_warning(told, "unknown_words", "words that the dictionary lacks", p->unknown_count, 0,
                      "");
        facts_warning_list(told, "unknown", "they are spelt by rules", p->unknown);
    }
    if (p->note[0])
        facts_warning_list(told, "notes", "note", p->note);
}

static mrt_result speak(speaking *self, error *err)
{
    take_call *call = self->call;
    char made[32];
    edit e;
    mrt_result result = read_options(self, err);
    if (result >= 0 && call->text[TAKE_FACE]) /* before a take is made for nothing */
        result = open_face(self, err);
    if (result >= 0)
        result = open_show(call, err);
    if (result == MRT_OK && call->text[TAKE_SOUND])
        result = make_take(call, made, err);
    if (result == MRT_OK)
        result = take_read(call, call->text[TAKE_SOUND] ? made : call->word[1], &self->take, err);
    if (result == MRT_OK && !call->text[TAKE_FACE])
        result = open_face(self, err);
    if (result != MRT_OK)
        return result;
    progress_start(&call->shown, "voice");
    result = voice_mouth_make(&e, &self->report, &self->sounds, call->show, &self->settings, err);
    progress_end(&call->shown);
    if (result == MRT_END)
        return error_set(err, MRT_ERR_IO, "cancelled. The take is unchanged");
    if (result == MRT_OK)
        result = add_layer(self, &e, err);
    if (result == MRT_OK && call->text[TAKE_OUT])
        result = write_sounds(self, call->text[TAKE_OUT], err);
    if (result == MRT_OK)
        report(self);
    return result;
}

mrt_result take_mouth_run(take_call *call, error *err)
{
    speaking self = {.call = call};
    const mrt_result result = speak(&self, err);
    phone_list_finish(&self.sounds);
    take_performance_finish(&self.like);
    face_file_destroy(&self.face);
    free(self.face_path);
    file_bytes_finish(&self.words);
    take_finish(&self.take);
    return result;
}
