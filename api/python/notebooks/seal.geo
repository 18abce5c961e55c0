// The section of a seal with two lips, in millimetres, drawn for Gmsh; seal.msh is made of it by
//   gmsh -2 -format msh22 seal.geo
// The floor sits in its groove, the lid comes down on the lips, the fluid is to the left.
coarse = 0.30;
fine = 0.09;
Point(1) = {-3, 0, 0, coarse};
Point(2) = { 3, 0, 0, coarse};
Point(3) = { 3, 1.6, 0, coarse};
Point(4) = { 2.6, 2, 0, fine};
Point(5) = { 1.6, 3, 0, fine};   // the top of the right lip
Point(6) = { 0.6, 2, 0, fine};
Point(7) = {-0.6, 2, 0, fine};
Point(8) = {-1.6, 3, 0, fine};   // the top of the left lip
Point(9) = {-2.6, 2, 0, fine};
Point(10) = {-3, 1.6, 0, coarse};
Point(11) = { 1.6, 2, 0, fine};  // centres of the lips
Point(12) = {-1.6, 2, 0, fine};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Circle(4) = {4, 11, 5};
Circle(5) = {5, 11, 6};
Line(6) = {6, 7};
Circle(7) = {7, 12, 8};
Circle(8) = {8, 12, 9};
Line(9) = {9, 10};
Line(10) = {10, 1};
Curve Loop(1) = {1:10};
Plane Surface(1) = {1};
Physical Curve("floor") = {1};
Physical Curve("back") = {2, 3};
Physical Curve("lips") = {4, 5, 7, 8};
Physical Curve("valley") = {6};
Physical Curve("fluid") = {9, 10};
Physical Surface("rubber") = {1};
