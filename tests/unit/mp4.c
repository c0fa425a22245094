/* Whether an .mp4 is complete: what its boxes and its index say, whatever the bytes are. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "stream/mp4.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

typedef struct bytes {
    uint8_t at[512];
    size_t size;
} bytes;

static void add_number(bytes *b, uint32_t value)
{
    for (int shift = 24; shift >= 0; shift -= 8)
        b->at[b->size++] = (uint8_t)(value >> shift);
}

/* Returns where its size is noted when it is known. */
static size_t begin_box(bytes *b, const char type[5])
{
    const size_t at = b->size;
    add_number(b, 0);
    memcpy(b->at + b->size, type, 4);
    b->size += 4;
    return at;
}

static void end_box(bytes *b, size_t at)
{
    bytes size = {.size = 0};
    add_number(&size, (uint32_t)(b->size - at));
    memcpy(b->at + at, size.at, 4);
}

static void add_track(bytes *b, const char handler[5], uint32_t samples)
{
    const size_t trak = begin_box(b, "trak"), mdia = begin_box(b, "mdia");
    const size_t hdlr = begin_box(b, "hdlr");
    add_number(b, 0);
    add_number(b, 0);
    memcpy(b->at + b->size, handler, 4);
    b->size += 4;
    end_box(b, hdlr);
    const size_t minf = begin_box(b, "minf"), stbl = begin_box(b, "stbl");
    const size_t stsz = begin_box(b, "stsz");
    add_number(b, 0);
    add_number(b, 1);
    add_number(b, samples);
    end_box(b, stsz);
    end_box(b, stbl);
    end_box(b, minf);
    end_box(b, mdia);
    end_box(b, trak);
}

/* Pictures, sound, a track of time code; the index first, as ffmpeg writes it. */
static bytes film_of(uint32_t pictures)
{
    bytes b = {.size = 0};
    end_box(&b, begin_box(&b, "ftyp"));
    const size_t moov = begin_box(&b, "moov");
    add_track(&b, "vide", pictures);
    add_track(&b, "soun", 9);
    add_track(&b, "tmcd", 1);
    end_box(&b, moov);
    const size_t mdat = begin_box(&b, "mdat");
    for (int i = 0; i < 5; ++i)
        add_number(&b, 0xffffffff);
    end_box(&b, mdat);
    return b;
}

static mp4_facts facts_of(const bytes *b, size_t size)
{
    mp4_facts out;
    FILE *file = tmpfile();
    assert_non_null(file);
    assert_int_equal(fwrite(b->at, 1, size, file), size);
    assert_int_equal(fflush(file), 0);
    mp4_read(&out, fileno(file));
    (void)fclose(file);
    return out;
}

static void a_film_that_is_there_counts_its_pictures(void **state)
{
    (void)state;
    const bytes film = film_of(70000);
    const mp4_facts of = facts_of(&film, film.size);
    assert_true(of.is_complete);
    assert_true(of.picture_count == 70000);
    assert_true(of.has_sound);
}

static void a_film_that_is_cut_anywhere_is_not_complete(void **state)
{
    (void)state;
    const bytes film = film_of(5);
    size_t moov_end = film.size - 28;
    for (size_t size = 0; size < film.size; ++size)
        if (size != moov_end) /* there it is a film whose pictures are elsewhere */
            assert_false(facts_of(&film, size).is_complete);
}

static void a_film_without_an_index_is_not_complete(void **state)
{
    (void)state;
    bytes b = {.size = 0};
    end_box(&b, begin_box(&b, "ftyp"));
    end_box(&b, begin_box(&b, "free"));
    end_box(&b, begin_box(&b, "mdat"));
    assert_false(facts_of(&b, b.size).is_complete);
    bytes open = film_of(5);
    memset(open.at + open.size - 28, 0, 4); /* "to the end of the file": nobody came back to it */
    assert_false(facts_of(&open, open.size).is_complete);
}

static void sizes_of_64_bits_are_read(void **state)
{
    (void)state;
    bytes b = film_of(5);
    const size_t at = begin_box(&b, "mdat");
    b.at[at + 3] = 1;
    add_number(&b, 0);
    add_number(&b, 20);
    add_number(&b, 0);
    assert_true(facts_of(&b, b.size).is_complete);
    b.at[at + 8] = 0x80; /* beyond every file */
    assert_false(facts_of(&b, b.size).is_complete);
    b.at[at + 8] = 0;
    b.at[at + 15] = 15; /* less than its own head */
    assert_false(facts_of(&b, b.size).is_complete);
}

static void boxes_within_boxes_end(void **state)
{
    (void)state;
    bytes b = {.size = 0};
    size_t at[32];
    for (int i = 0; i < 32; ++i)
        at[i] = begin_box(&b, i % 2 ? "trak" : "moov");
    for (int i = 31; i >= 0; --i)
        end_box(&b, at[i]);
    assert_false(facts_of(&b, b.size).is_complete);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_film_that_is_there_counts_its_pictures),
        cmocka_unit_test(a_film_that_is_cut_anywhere_is_not_complete),
        cmocka_unit_test(a_film_without_an_index_is_not_complete),
        cmocka_unit_test(sizes_of_64_bits_are_read),
        cmocka_unit_test(boxes_within_boxes_end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
