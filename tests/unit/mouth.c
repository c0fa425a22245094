/* A mouth that says sounds: closures are complete, visemes are in order and ahead of their sounds,
 * strengths stay in range; texts as words and spelling; sounds by loudness. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "stage/voice/mouth.h"
#include "stage/voice/words.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SOUNDS_MAX = 64 };

static phone_list say(const phone_sound *sound, uint32_t count, double length_s)
{
    phone_list out = {0};
    error err;
    for (uint32_t i = 0; i < count; ++i)
        assert_true(phone_list_add(&out, sound[i], 0.5 + i * length_s, 0.5 + (i + 1) * length_s,
                                   &err) >= 0);
    return out;
}

static mouth shaped(const phone_list *sounds)
{
    mouth out;
    error err;
    assert_true(mouth_create(&out, sounds, &err) >= 0);
    return out;
}

static double greatest(const mouth *of, mouth_viseme viseme, double from_s, double to_s,
                       double *out_at_s)
{
    double most = 0.0;
    for (double t = from_s; t <= to_s; t += 1.0 / 60.0) {
        const double now = mouth_at(of, t, 1.0, 1.0).amount[viseme];
        if (now > most) {
            most = now;
            *out_at_s = t;
        }
    }
    return most;
}

/* Whatever surrounds it and however fast, at a frame of the palette's rate. */
static void closures_are_complete(void **state)
{
    static const phone_sound closures[] = {PHONE_P, PHONE_B, PHONE_M, PHONE_F, PHONE_V};
    static const phone_sound around[] = {PHONE_AA, PHONE_UW, PHONE_S, PHONE_T, PHONE_REST};
    (void)state;
    for (int c = 0; c < 5; ++c)
        for (int a = 0; a < 5; ++a)
            for (int b = 0; b < 5; ++b)
                for (double length_s = 0.03; length_s < 0.2; length_s += 0.02) {
                    const phone_sound sounds[] = {PHONE_T, around[a], closures[c], around[b],
                                                  PHONE_AA};
                    phone_list list = say(sounds, 5, length_s);
                    mouth m = shaped(&list);
                    double at_s = 0.0;
                    const mouth_viseme viseme = c < 3 ? MOUTH_PP : MOUTH_FF;
                    const double most = greatest(&m, viseme, 0.3, 1.6, &at_s);
                    assert_true(most >= 0.999);
                    assert_true(fabs(at_s - list.phone[2].start_s) < 0.12);
                    mouth_finish(&m);
                    phone_list_finish(&list);
                }
}

/* The times at which each viseme of "mama" and "five" is reached: golden. */
static void a_mouth_is_ahead_of_its_sounds(void **state)
{
    static const phone_sound sounds[] = {PHONE_F, PHONE_AY, PHONE_V, PHONE_P, PHONE_UW, PHONE_M};
    static const mouth_viseme viseme[] = {MOUTH_FF, MOUTH_AA, MOUTH_I,  MOUTH_FF,
                                          MOUTH_PP, MOUTH_U,  MOUTH_PP, MOUTH_PP};
    static const double reached_ms[] = {455, 492, 540, 555, 655, 710, 755};
    (void)state;
    phone_list list = say(sounds, 6, 0.1);
    mouth m = shaped(&list);
    assert_int_equal(m.count, 9); /* with rest at both ends */
    assert_true(m.key[0].reached_s < m.key[1].reached_s);
    for (uint32_t k = 1; k < 8; ++k) {
        assert_true(m.key[k].amount[viseme[k - 1]] > 0.5);
        assert_true(m.key[k].reached_s >= m.key[k - 1].left_s);
        assert_true(m.key[k].left_s >= m.key[k].reached_s);
    }
    assert_true(fabs(1e3 * m.key[1].reached_s - reached_ms[0]) < 1.0);
    for (uint32_t i = 0; i < list.count; ++i) { /* 60 to 120 ms before the middle of a sound */
        const double middle_s = 0.5 * (list.phone[i].start_s + list.phone[i].end_s);
        bool is_ahead = false;
        for (uint32_t k = 1; k < 8; ++k)
            is_ahead |=
                m.key[k].reached_s < middle_s - 0.01 && m.key[k].reached_s > middle_s - 0.12;
        assert_true(is_ahead);
    }
    mouth_finish(&m);
    phone_list_finish(&list);
}

static void strengths_stay_in_range_and_pauses_are_rest(void **state)
{
    uint64_t seed = 7;
    (void)state;
    for (int round = 0; round < 200; ++round) {
        phone_list list = {0};
        error err;
        double at_s = 0.0;
        for (int i = 0; i < SOUNDS_MAX; ++i) {
            seed = seed * 6364136223846793005u + 1442695040888963407u;
            const double length_s = 0.02 + (double)(seed >> 40 & 255) * 0.001;
            assert_true(phone_list_add(&list, (phone_sound)((seed >> 33) % PHONE_COUNT), at_s,
                                       at_s + length_s, &err) >= 0);
            list.phone[i].effort = (double)(seed >> 50 & 255) / 127.5 - 1.0;
            at_s += length_s;
        }
        assert_true(phone_list_add(&list, PHONE_REST, at_s, at_s + 1.0, &err) >= 0);
        mouth m = shaped(&list);
        double last = 0.0;
        for (double t = -0.5; t < at_s + 1.0; t += 1.0 / 60.0) {
            const mouth_shape s = mouth_at(&m, t, 1.0, 0.5);
            double sum = 0.0;
            for (int v = 0; v < MOUTH_VISEMES; ++v) {
                assert_true(s.amount[v] >= 0.0 && s.amount[v] <= 1.0);
                sum += s.amount[v];
            }
            assert_true(sum <= 1.0 + 1e-9);
            assert_true(s.jaw >= 0.5 && s.jaw <= 1.4 && s.lips >= 0.5 && s.lips <= 1.0);
            last = sum;
        }
        assert_true(last <= 1e-9);
        mouth_finish(&m);
        phone_list_finish(&list);
    }
}

/* A loud vowel opens the jaw more, and little lips still close. */
static void jaw_and_lips_are_two_axes(void **state)
{
    static const phone_sound sounds[] = {PHONE_T, PHONE_AA, PHONE_M, PHONE_AA, PHONE_T};
    (void)state;
    phone_list list = say(sounds, 5, 0.15);
    list.phone[1].effort = -1.0;
    list.phone[3].effort = 1.0;
    mouth m = shaped(&list);
    double quiet_s = 0.0, loud_s = 0.0, closed_s = 0.0;
    (void)greatest(&m, MOUTH_AA, 0.55, 0.75, &quiet_s);
    (void)greatest(&m, MOUTH_AA, 0.85, 1.05, &loud_s);
    assert_true(greatest(&m, MOUTH_PP, 0.7, 0.95, &closed_s) >= 1.0);
    assert_true(mouth_at(&m, loud_s, 1.0, 1.0).jaw > mouth_at(&m, quiet_s, 1.0, 1.0).jaw + 0.2);
    assert_true(mouth_at(&m, loud_s, 0.5, 1.0).jaw < 0.75);
    assert_true(mouth_at(&m, loud_s, 1.0, 0.25).lips < 0.3);
    assert_true(mouth_at(&m, closed_s, 1.0, 0.25).lips > 0.999);
    mouth_finish(&m);
    phone_list_finish(&list);
}

static void a_short_vowel_is_weaker(void **state)
{
    static const phone_sound sounds[] = {PHONE_S, PHONE_AA, PHONE_S};
    (void)state;
    phone_list quick = say(sounds, 3, 0.06), slow = say(sounds, 3, 0.2);
    mouth a = shaped(&quick), b = shaped(&slow);
    double at_s;
    assert_true(greatest(&a, MOUTH_AA, 0.3, 1.2, &at_s) <
                greatest(&b, MOUTH_AA, 0.3, 1.2, &at_s) - 0.15);
    mouth_finish(&a);
    mouth_finish(&b);
    phone_list_finish(&quick);
    phone_list_finish(&slow);
}

/* ---- words ---- */

static void texts_become_words(void **state)
{
    word_list list;
    error err;
    (void)state;
    assert_true(word_list_parse(&list, "It's 'Bob' - 2 O'Clock!\n\xc3\xa9t\xc3\xa9", &err) >= 0);
    assert_int_equal(list.count, 5);
    assert_string_equal(list.word[0], "it's");
    assert_string_equal(list.word[1], "bob");
    assert_string_equal(list.word[2], "two");
    assert_string_equal(list.word[3], "o'clock");
    assert_string_equal(list.word[4], "t");
    word_list_finish(&list);
}

static void hostile_texts_are_refused(void **state)
{
    word_list list;
    error err;
    char *text = malloc(PHONES_WORDS_BYTES + 2);
    (void)state;
    assert_non_null(text);
    memset(text, 'a', PHONES_WORDS_BYTES + 1);
    text[PHONES_WORDS_BYTES + 1] = '\0';
    assert_true(word_list_parse(&list, text, &err) < 0);
    assert_non_null(strstr(err.text, "bytes"));
    text[1000] = '\0';
    assert_true(word_list_parse(&list, text, &err) < 0);
    assert_non_null(strstr(err.text, "letters"));
    for (int i = 0; i < PHONES_WORDS_BYTES; ++i)
        text[i] = i % 2 ? ' ' : 'a';
    text[PHONES_WORDS_BYTES] = '\0';
    assert_true(word_list_parse(&list, text, &err) < 0);
    assert_non_null(strstr(err.text, "words"));
    assert_true(word_list_parse(&list, " ... \xff\xfe", &err) < 0);
    free(text);
}

static void unknown_words_are_spelt(void **state)
{
    phone_sound sound[WORD_SOUNDS];
    (void)state;
    assert_int_equal(word_spell(sound, "marotte"), 5); /* M AE R AA T */
    assert_int_equal(sound[0], PHONE_M);
    assert_int_equal(sound[4], PHONE_T);
    assert_int_equal(word_spell(sound, "phish"), 3);
    assert_int_equal(sound[0], PHONE_F);
    assert_int_equal(sound[2], PHONE_SH);
    assert_int_equal(word_spell(sound, "e"), 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(closures_are_complete),
        cmocka_unit_test(a_mouth_is_ahead_of_its_sounds),
        cmocka_unit_test(strengths_stay_in_range_and_pauses_are_rest),
        cmocka_unit_test(jaw_and_lips_are_two_axes),
        cmocka_unit_test(a_short_vowel_is_weaker),
        cmocka_unit_test(texts_become_words),
        cmocka_unit_test(hostile_texts_are_refused),
        cmocka_unit_test(unknown_words_are_spelt),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
