/* SPDX-License-Identifier: MIT */
/*
 * ref_seen.h - what the decoder met: one counter for each branch of SPEC.md,
 * so that a test can tell which of them its files reach.
 */
#ifndef REF_SEEN_H
#define REF_SEEN_H

#include <stdint.h>

/* Section, name. */
#define REF_ELEMENTS(X)            \
    X("5.2", skippable)            \
    X("5.2", names)                \
    X("5.2", block_goes_on)        \
    X("5.3", parents_move)         \
    X("5.3", lossless)             \
    X("5.3", joined)               \
    X("5.3", measured)             \
    X("5.3", attribute_normal)     \
    X("5.3", attribute_texture)    \
    X("5.3", attribute_colour)     \
    X("5.3", attribute_generic)    \
    X("6.1", byte_behind_end)      \
    X("6.1", number_raw)           \
    X("6.2", seed)                 \
    X("6.2", seed_again)           \
    X("6.2", gate_boundary)        \
    X("6.2", gate_new)             \
    X("6.2", neighbour_0)          \
    X("6.2", neighbour_1)          \
    X("6.2", base_vertex_number)   \
    X("6.2", candidate_far)        \
    X("6.2", fan_known)            \
    X("6.3", visit_again)          \
    X("6.3", visit_large_ring)     \
    X("6.3", flag_kept)            \
    X("6.3", cut_closed)           \
    X("6.3", cut_open)             \
    X("6.3", cut_ghost_first)      \
    X("6.3", cut_ghost_end)        \
    X("6.3", cut_without_faces)    \
    X("6.3", cut_several)          \
    X("6.3", fan_stays)            \
    X("6.3", fan_moves)            \
    X("6.3", lone_plain)           \
    X("6.3", lone_turned)          \
    X("6.3", lone_pair)            \
    X("6.3", third_member)         \
    X("6.3", third_far)            \
    X("6.4", cut_drift)            \
    X("6.4", cut_rank_above_3)     \
    X("6.4", cut_only_one_left)    \
    X("6.4", cut_share_0)          \
    X("6.4", cut_plain)            \
    X("6.5", guess_large_ring)     \
    X("6.5", guess_left_out)       \
    X("6.5", predict_large_ring)   \
    X("6.5", normal_0)             \
    X("6.5", bend_left_out)        \
    X("6.5", centre_0)             \
    X("6.5", straight_short)       \
    X("6.5", parent_clamped)       \
    X("6.5", residual_low)         \
    X("6.5", residual_raw)         \
    X("6.5", residual_escape)      \
    X("6.5", ratio_limited)        \
    X("6.6", material_second)      \
    X("6.6", material_picked)      \
    X("6.6", ordinary)             \
    X("6.6", not_ordinary)         \
    X("6.6", v_without_guess)      \
    X("6.6", lone_like_child)      \
    X("6.6", child_seam)           \
    X("6.6", child_place)          \
    X("6.6", corner_second)        \
    X("6.6", corner_place)         \
    X("6.6", corner_new)           \
    X("6.6", place)                \
    X("6.6", wedge_without_coarse) \
    X("6.6", value_copied)         \
    X("6.6", normal_at_boundary)   \
    X("6.6", shape_0)              \
    X("6.6", mirrored)             \
    X("6.6", tangent)              \
    X("6.6", tangent_0)            \
    X("6.6", tangent_below)        \
    X("6.6", value_from_sibling)   \
    X("6.6", value_from_parent)    \
    X("6.6", value_half)           \
    X("6.6", values_48)            \
    X("6.7", key_rounded)          \
    X("6.7", wedge_left_over)      \
    X("6.8", form_decimal)         \
    X("6.8", form_binary)          \
    X("6.8", exact_known)          \
    X("6.8", exact_hole)           \
    X("6.8", exact_same)           \
    X("6.8", exact_nothing_left)   \
    X("6.8", exact_stray)          \
    X("6.8", exact_uniform)        \
    X("6.8", uniform_raw)          \
    X("6.8", uniform_beyond)       \
    X("6.8", ordinal_most)

#define REF_ELEMENT_ID(section, name) REF_ELEMENT_##name,
typedef enum ref_element {
    REF_ELEMENTS(REF_ELEMENT_ID) REF_ELEMENT_COUNT
} ref_element;

extern uint64_t ref_seen[REF_ELEMENT_COUNT];

#define REF_SEEN(name) (void)ref_seen[REF_ELEMENT_##name]++

/* Prints counts by section, one element a line if `all`; returns how many
 * were never met. */
int ref_seen_print(int all);

#endif
