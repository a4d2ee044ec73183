// SPDX-License-Identifier: MIT
// The result of a rectangle test, three cycles after its definition, for tester_exact and tester_products.
always @(posedge clk) begin
    valid <= {valid, started};
    hits <= {hits, defined};
    in_mirrors <= {in_mirrors, in_mirror};
    n_1 <= n; n_2 <= n_1; n_3 <= n_2;
    e_1 <= e; e_2 <= e_1; e_3 <= e_2;
end
always @* if (valid[2]) begin
    assert (hit == hits[2]);
    if (hit) assert (numerator == n_3 && denominator == e_3);
    if (hit) assert (at_mirror == in_mirrors[2]);
end

always @* cover (valid[2] && hit);
generate
    if (REFLECTIONS > 1) begin: corners
        always @* cover (valid[2] && hit && at_mirror);
    end
endgenerate
