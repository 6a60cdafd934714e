/* SPDX-License-Identifier: MIT */
#include "format/tables.h"

const int16_t pmesh_cut_shape[3][2][5] = {
    { { 60, 300, 20, 20, 0 }, { 60, 300, 20, 20, 60 } },
    { { 60, 100, 20, 20, 0 }, { 60, 100, 20, 20, 60 } },
    { { 60, 0, 20, 0, 0 }, { 60, 0, 20, 0, 60 } },
};

const int16_t pmesh_cut_degree[PMESH_CUT_DEGREES] = { 0 };

const int16_t pmesh_cut_state[PMESH_STATES][PMESH_STATES][PMESH_STATES] = {
    { { 0 } }
};

const int16_t pmesh_cut_span[2][PMESH_CUT_RINGS][PMESH_CUT_SPANS] = {
    { { 0 } }
};

const int16_t pmesh_predict_weight[PMESH_PREDICT_KINDS]
                                  [PMESH_PREDICT_CLASSES][3]
                                  [PMESH_PREDICT_TERMS][2] = {
    { { { { 0 } } } }
};
