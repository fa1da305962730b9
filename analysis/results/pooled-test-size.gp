# Draws pooled-test-size.svg and pooled-test-size.pdf: gnuplot pooled-test-size.gp
set encoding utf8
set terminal svg size 960,480 noenhanced font 'Helvetica,14' background '#ffffff'
set output 'pooled-test-size.svg'
set multiplot layout 1,2 margins 0.10,0.98,0.15,0.80 spacing 0.07
set xrange [-0.01:0.51]
set logscale y
set yrange [0.02:0.5]
set ytics (0.02, 0.03, 0.04, 0.05, 0.07, 0.1, 0.2, 0.3, 0.4)
set xlabel 'correlation of one participant''s answers (ICC)'
set grid ytics lc rgb '#e0e0e0' lt 1
set border 3
set tics nomirror scale 0.5
set xtics 0,0.1,0.5
set object 1 rectangle from graph 0, first 0.043461651584688996 to graph 1, first 0.05653834841531101 fc rgb '#dddddd' fs solid noborder behind
$p0t0 << EOD
0 0.042
0.05 0.0816
0.1 0.1238
0.2 0.1878
0.3 0.2443
0.4 0.2938
0.5 0.3516
EOD
$p0t1 << EOD
0 0.042
0.05 0.0816
0.1 0.1238
0.2 0.1878
0.3 0.2443
0.4 0.2938
0.5 0.3516
EOD
$p0t2 << EOD
0 0.0655
0.05 0.0641
0.1 0.0632
0.2 0.0635
0.3 0.0613
0.4 0.0587
0.5 0.0591
EOD
$p0t3 << EOD
0 0.0464
0.05 0.0465
0.1 0.0458
0.2 0.0423
0.3 0.043
0.4 0.0419
0.5 0.0399
EOD
$p0t4 << EOD
0 0.029
0.05 0.0323
0.1 0.0347
0.2 0.0347
0.3 0.0387
0.4 0.0412
0.5 0.0421
EOD
$p0t5 << EOD
0 0.0431
0.05 0.0467
0.1 0.0452
0.2 0.044
0.3 0.0435
0.4 0.0436
0.5 0.0396
EOD
set title '16 participants' offset 0,-0.5
set ylabel 'false-positive rate'
set key at screen 0.5, 0.99 center top maxrows 2 width 1
plot $p0t0 using 1:2 with linespoints lw 2 ps 1.2 pt 7 lc rgb '#D55E00' title 'chi-square (naive)', \
  $p0t1 using 1:2 with linespoints lw 2 ps 0.6 pt 5 lc rgb '#E69F00' title 'exact binomial (naive)', \
  $p0t2 using 1:2 with linespoints lw 2 ps 0.7 pt 9 lc rgb '#56B4E9' title 'Rao-Scott, chi-square', \
  $p0t3 using 1:2 with linespoints lw 2 ps 0.7 pt 11 lc rgb '#0072B2' title 'Rao-Scott, F', \
  $p0t4 using 1:2 with linespoints lw 2 ps 0.8 pt 13 lc rgb '#009E73' title 'sign flip', \
  $p0t5 using 1:2 with linespoints lw 2 ps 0.7 pt 15 lc rgb '#CC79A7' title 'cluster bootstrap'
$p1t0 << EOD
0 0.0461
0.05 0.0888
0.1 0.127
0.2 0.2016
0.3 0.2573
0.4 0.3031
0.5 0.3538
EOD
$p1t1 << EOD
0 0.0461
0.05 0.0888
0.1 0.127
0.2 0.2016
0.3 0.2573
0.4 0.3031
0.5 0.3538
EOD
$p1t2 << EOD
0 0.0534
0.05 0.0538
0.1 0.0537
0.2 0.0548
0.3 0.0515
0.4 0.0496
0.5 0.0514
EOD
$p1t3 << EOD
0 0.0476
0.05 0.0493
0.1 0.0496
0.2 0.0496
0.3 0.0472
0.4 0.0453
0.5 0.047
EOD
$p1t4 << EOD
0 0.0398
0.05 0.0419
0.1 0.0434
0.2 0.0444
0.3 0.0436
0.4 0.0426
0.5 0.0456
EOD
$p1t5 << EOD
0 0.0479
0.05 0.0505
0.1 0.0495
0.2 0.0506
0.3 0.049
0.4 0.0471
0.5 0.0497
EOD
set title '64 participants' offset 0,-0.5
set ylabel ''
unset key
plot $p1t0 using 1:2 with linespoints lw 2 ps 1.2 pt 7 lc rgb '#D55E00' title 'chi-square (naive)', \
  $p1t1 using 1:2 with linespoints lw 2 ps 0.6 pt 5 lc rgb '#E69F00' title 'exact binomial (naive)', \
  $p1t2 using 1:2 with linespoints lw 2 ps 0.7 pt 9 lc rgb '#56B4E9' title 'Rao-Scott, chi-square', \
  $p1t3 using 1:2 with linespoints lw 2 ps 0.7 pt 11 lc rgb '#0072B2' title 'Rao-Scott, F', \
  $p1t4 using 1:2 with linespoints lw 2 ps 0.8 pt 13 lc rgb '#009E73' title 'sign flip', \
  $p1t5 using 1:2 with linespoints lw 2 ps 0.7 pt 15 lc rgb '#CC79A7' title 'cluster bootstrap'
unset multiplot
reset
set terminal pdfcairo size 10.000,5.000 noenhanced font 'Helvetica,11'
set output 'pooled-test-size.pdf'
set multiplot layout 1,2 margins 0.10,0.98,0.15,0.80 spacing 0.07
set xrange [-0.01:0.51]
set logscale y
set yrange [0.02:0.5]
set ytics (0.02, 0.03, 0.04, 0.05, 0.07, 0.1, 0.2, 0.3, 0.4)
set xlabel 'correlation of one participant''s answers (ICC)'
set grid ytics lc rgb '#e0e0e0' lt 1
set border 3
set tics nomirror scale 0.5
set xtics 0,0.1,0.5
set object 1 rectangle from graph 0, first 0.043461651584688996 to graph 1, first 0.05653834841531101 fc rgb '#dddddd' fs solid noborder behind
$p0t0 << EOD
0 0.042
0.05 0.0816
0.1 0.1238
0.2 0.1878
0.3 0.2443
0.4 0.2938
0.5 0.3516
EOD
$p0t1 << EOD
0 0.042
0.05 0.0816
0.1 0.1238
0.2 0.1878
0.3 0.2443
0.4 0.2938
0.5 0.3516
EOD
$p0t2 << EOD
0 0.0655
0.05 0.0641
0.1 0.0632
0.2 0.0635
0.3 0.0613
0.4 0.0587
0.5 0.0591
EOD
$p0t3 << EOD
0 0.0464
0.05 0.0465
0.1 0.0458
0.2 0.0423
0.3 0.043
0.4 0.0419
0.5 0.0399
EOD
$p0t4 << EOD
0 0.029
0.05 0.0323
0.1 0.0347
0.2 0.0347
0.3 0.0387
0.4 0.0412
0.5 0.0421
EOD
$p0t5 << EOD
0 0.0431
0.05 0.0467
0.1 0.0452
0.2 0.044
0.3 0.0435
0.4 0.0436
0.5 0.0396
EOD
set title '16 participants' offset 0,-0.5
set ylabel 'false-positive rate'
set key at screen 0.5, 0.99 center top maxrows 2 width 1
plot $p0t0 using 1:2 with linespoints lw 2 ps 1.2 pt 7 lc rgb '#D55E00' title 'chi-square (naive)', \
  $p0t1 using 1:2 with linespoints lw 2 ps 0.6 pt 5 lc rgb '#E69F00' title 'exact binomial (naive)', \
  $p0t2 using 1:2 with linespoints lw 2 ps 0.7 pt 9 lc rgb '#56B4E9' title 'Rao-Scott, chi-square', \
  $p0t3 using 1:2 with linespoints lw 2 ps 0.7 pt 11 lc rgb '#0072B2' title 'Rao-Scott, F', \
  $p0t4 using 1:2 with linespoints lw 2 ps 0.8 pt 13 lc rgb '#009E73' title 'sign flip', \
  $p0t5 using 1:2 with linespoints lw 2 ps 0.7 pt 15 lc rgb '#CC79A7' title 'cluster bootstrap'
$p1t0 << EOD
0 0.0461
0.05 0.0888
0.1 0.127
0.2 0.2016
0.3 0.2573
0.4 0.3031
0.5 0.3538
EOD
$p1t1 << EOD
0 0.0461
0.05 0.0888
0.1 0.127
0.2 0.2016
0.3 0.2573
0.4 0.3031
0.5 0.3538
EOD
$p1t2 << EOD
0 0.0534
0.05 0.0538
0.1 0.0537
0.2 0.0548
0.3 0.0515
0.4 0.0496
0.5 0.0514
EOD
$p1t3 << EOD
0 0.0476
0.05 0.0493
0.1 0.0496
0.2 0.0496
0.3 0.0472
0.4 0.0453
0.5 0.047
EOD
$p1t4 << EOD
0 0.0398
0.05 0.0419
0.1 0.0434
0.2 0.0444
0.3 0.0436
0.4 0.0426
0.5 0.0456
EOD
$p1t5 << EOD
0 0.0479
0.05 0.0505
0.1 0.0495
0.2 0.0506
0.3 0.049
0.4 0.0471
0.5 0.0497
EOD
set title '64 participants' offset 0,-0.5
set ylabel ''
unset key
plot $p1t0 using 1:2 with linespoints lw 2 ps 1.2 pt 7 lc rgb '#D55E00' title 'chi-square (naive)', \
  $p1t1 using 1:2 with linespoints lw 2 ps 0.6 pt 5 lc rgb '#E69F00' title 'exact binomial (naive)', \
  $p1t2 using 1:2 with linespoints lw 2 ps 0.7 pt 9 lc rgb '#56B4E9' title 'Rao-Scott, chi-square', \
  $p1t3 using 1:2 with linespoints lw 2 ps 0.7 pt 11 lc rgb '#0072B2' title 'Rao-Scott, F', \
  $p1t4 using 1:2 with linespoints lw 2 ps 0.8 pt 13 lc rgb '#009E73' title 'sign flip', \
  $p1t5 using 1:2 with linespoints lw 2 ps 0.7 pt 15 lc rgb '#CC79A7' title 'cluster bootstrap'
unset multiplot
set output
